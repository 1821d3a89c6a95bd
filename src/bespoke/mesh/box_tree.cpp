#include "bespoke/mesh/box_tree.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <span>
#include <utility>

namespace bespoke {
namespace {

constexpr int width = BoxTree::width;
constexpr int leaf_size = BoxTree::leaf_size;
constexpr int bins = 16;           // candidate planes of a split
constexpr int balanced_from = 24;  // levels
static_assert(BoxTree::stack_size >= (balanced_from + 16) * (width - 1) + width);

using Node = BoxTree::Node;

struct Range {
  int begin, end;
  int depth;
  int size() const { return end - begin; }
};

void set_bounds(Node& node, std::size_t i, const Box& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node.low[axis][i] = round_down(box.min()(axis));
    node.high[axis][i] = round_up(box.max()(axis));
  }
}

/// Around all children.
Box bounds_of(const Node& node) {
  Box box;
  for (int i = 0; i < width; ++i) {
    if (node.count[i] < 0) continue;
    box.extend(Vector3(node.low[0][i], node.low[1][i], node.low[2][i]));
    box.extend(Vector3(node.high[0][i], node.high[1][i], node.high[2][i]));
  }
  return box;
}

class Builder {
 public:
  explicit Builder(const std::vector<Box>& boxes) {
    items_.reserve(boxes.size());
    for (const Box& box : boxes) items_.push_back({rounded(box), static_cast<int>(items_.size())});
  }

  BoxTree build() && {
    std::vector<Node> nodes(1);
    std::vector<std::pair<std::size_t, Range>> pending{{0, {0, static_cast<int>(items_.size()), 0}}};
    while (!pending.empty()) {
      const auto [node, range] = pending.back();
      pending.pop_back();
      const std::vector<Range> parts = divide(range);
      for (std::size_t i = 0; i < width; ++i) {
        const bool used = i < parts.size();
        set_child(nodes[node], i, used ? bounds(parts[i]) : FloatBox(), used ? parts[i].begin : 0,
                  used ? parts[i].size() : -1);
        if (!used || parts[i].size() <= leaf_size) continue;
        nodes[node].child[i] = static_cast<int>(nodes.size());
        nodes[node].count[i] = 0;
        pending.push_back({nodes.size(), {parts[i].begin, parts[i].end, range.depth + 1}});
        nodes.emplace_back();
      }
    }
    std::vector<int> order(items_.size());
    std::transform(items_.begin(), items_.end(), order.begin(), [](const Item& item) { return item.index; });
    return {std::move(nodes), std::move(order)};
  }

 private:
  using FloatBox = Eigen::AlignedBox3f;

  /// What is sorted: walks over a range read one short stretch of memory.
  struct Item {
    FloatBox box;  // rounded outwards
    int index;
    Eigen::Vector3f doubled_center() const { return box.min() + box.max(); }
  };

  static FloatBox rounded(const Box& box) {
    return {Eigen::Vector3f(box.min().unaryExpr(&round_down)),
            Eigen::Vector3f(box.max().unaryExpr(&round_up))};
  }

  std::span<Item> items(const Range& range) {
    return std::span(items_).subspan(static_cast<std::size_t>(range.begin),
                                     static_cast<std::size_t>(range.size()));
  }

  FloatBox bounds(const Range& range) {
    FloatBox box;
    for (const Item& item : items(range)) box.extend(item.box);
    return box;
  }

  static void set_child(Node& node, std::size_t i, const FloatBox& box, int first, int count) {
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][i] = count < 0 ? 0 : box.min()(axis);
      node.high[axis][i] = count < 0 ? 0 : box.max()(axis);
    }
    node.child[i] = first;
    node.count[i] = count;
  }

  std::vector<Range> divide(const Range& range) {
    std::vector<Range> parts{range};
    while (parts.size() < width) {
      const auto largest = std::max_element(
          parts.begin(), parts.end(), [](const Range& x, const Range& y) { return x.size() < y.size(); });
      if (largest->size() <= leaf_size) break;
      const int middle = split(*largest);
      const Range upper{middle, largest->end, range.depth};
      largest->end = middle;
      parts.push_back(upper);
    }
    return parts;
  }

  // By the surface-area heuristic over bins of the centres along their longest axis (Wald 2007).
  int split(const Range& range) {
    const std::span<Item> all = items(range);
    FloatBox centers;
    for (const Item& item : all) centers.extend(item.doubled_center());
    int axis = 0;
    const float extent = centers.diagonal().maxCoeff(&axis);
    if (!(extent > 0 && std::isfinite(extent))) return range.begin + range.size() / 2;
    if (range.depth >= balanced_from) {
      const int half = range.size() / 2;
      std::nth_element(all.begin(), all.begin() + half, all.end(), [&](const Item& x, const Item& y) {
        return x.doubled_center()(axis) < y.doubled_center()(axis);
      });
      return range.begin + half;
    }
    const auto bin = [&](const Item& item) {
      const float share = (item.doubled_center()(axis) - centers.min()(axis)) / extent;
      return std::clamp(static_cast<int>(share * bins), 0, bins - 1);
    };
    const int cut = best_cut(all, bin);
    const auto middle =
        std::partition(all.begin(), all.end(), [&](const Item& item) { return bin(item) < cut; });
    return range.begin + static_cast<int>(middle - all.begin());
  }

  // Between 1 and bins − 1: the first and the last bin are never empty.
  template <class Bin>
  static int best_cut(std::span<const Item> items, const Bin& bin) {
    std::array<FloatBox, bins> bounds_of_bin;
    std::array<int, bins> count{};
    for (const Item& item : items) {
      const auto at = static_cast<std::size_t>(bin(item));
      bounds_of_bin[at].extend(item.box);
      ++count[at];
    }
    std::array<float, bins> cost{};
    const auto area = [](const FloatBox& b) {
      const Eigen::Vector3f d = b.diagonal();
      return d.x() * d.y() + d.y() * d.z() + d.z() * d.x();
    };
    FloatBox left, right;
    int left_count = 0, right_count = 0;
    for (std::size_t i = 0; i + 1 < bins; ++i) {
      left.extend(bounds_of_bin[i]);
      left_count += count[i];
      cost[i + 1] += area(left) * static_cast<float>(left_count);
      right.extend(bounds_of_bin[bins - 1 - i]);
      right_count += count[bins - 1 - i];
      cost[bins - 1 - i] += area(right) * static_cast<float>(right_count);
    }
    return static_cast<int>(std::min_element(cost.begin() + 1, cost.end()) - cost.begin());
  }

  std::vector<Item> items_;  ///< in the order of the leaves
};

}  // namespace

std::vector<Box> face_boxes(const TriangleMesh& mesh) {
  std::vector<Box> boxes(static_cast<std::size_t>(mesh.faces.cols()));
  for (std::size_t face = 0; face < boxes.size(); ++face)
    for (const int vertex : mesh.faces.col(static_cast<Eigen::Index>(face)))
      boxes[face].extend(mesh.vertices.col(vertex));
  return boxes;
}

BoxTree build_box_tree(const std::vector<Box>& boxes) {
  assert(!boxes.empty());
  return Builder(boxes).build();
}

void refit(BoxTree& tree, const std::vector<Box>& boxes) {
  assert(boxes.size() == tree.order.size());
  for (std::size_t n = tree.nodes.size(); n-- > 0;) {  // a node's children come after it
    Node& node = tree.nodes[n];
    for (std::size_t i = 0; i < width; ++i) {
      const auto first = static_cast<std::size_t>(node.child[i]);
      if (node.count[i] < 0) continue;
      Box box = node.count[i] == 0 ? bounds_of(tree.nodes[first]) : Box();
      for (std::size_t k = first; k < first + static_cast<std::size_t>(node.count[i]); ++k)
        box.extend(boxes[static_cast<std::size_t>(tree.order[k])]);
      set_bounds(node, i, box);
    }
  }
}

}  // namespace bespoke
