#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Bounding-volume tree over boxes, four children a node, whose boxes are floats rounded outwards (one SSE
/// register tests four). Leaves hold up to four boxes. The root is node 0.
struct BoxTree {
  static constexpr int width = 4;
  static constexpr int leaf_size = 4;
  /// Entries that a depth-first walk can have waiting: the depth is bounded, see build_box_tree.
  static constexpr int stack_size = 128;

  struct Node {
    alignas(16) float low[3][width];
    alignas(16) float high[3][width];
    int child[width];  ///< index of a node, or of a leaf's first entry in `order`
    int count[width];  ///< entries of a leaf; 0 for a node, -1 for nothing
  };

  std::vector<Node> nodes;
  std::vector<int> order;  ///< the boxes' indices, leaf by leaf
};

/// One per face. Indices of faces must be valid.
std::vector<Box> face_boxes(const TriangleMesh& mesh);

/// Splits by the surface-area heuristic over bins, and in halves below a depth of 24, so that 2^31 boxes need
/// at most 40 levels of three waiting nodes. `boxes` must not be empty, nor any of its elements.
BoxTree build_box_tree(const std::vector<Box>& boxes);

/// Fits the tree to the same boxes at other places, a fraction of the cost of building it. Results stay
/// exact; walks get slower where boxes that were neighbours have parted.
void refit(BoxTree& tree, const std::vector<Box>& boxes);

/// Calls visit(index) for every box that meets `box`, and perhaps for a few more, in the order of the tree.
template <class Visit>
void for_each_overlapping(const BoxTree& tree, const Box& box, const Visit& visit);

/// The largest float at most x, and the least at least x; infinite beyond a float's range.
inline float round_down(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded <= x ? rounded : std::nextafterf(rounded, -std::numeric_limits<float>::infinity());
}
inline float round_up(double x) {
  const auto rounded = static_cast<float>(x);
  return rounded >= x ? rounded : std::nextafterf(rounded, std::numeric_limits<float>::infinity());
}

template <class Visit>
void for_each_overlapping(const BoxTree& tree, const Box& box, const Visit& visit) {
  std::array<int, BoxTree::stack_size> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  std::array<float, 3> low, high;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = round_down(box.min()(static_cast<Eigen::Index>(axis)));
    high[axis] = round_up(box.max()(static_cast<Eigen::Index>(axis)));
  }
  while (top > 0) {
    const BoxTree::Node& node = tree.nodes[static_cast<std::size_t>(stack[--top])];
    for (int i = 0; i < BoxTree::width; ++i) {
      bool meets = node.count[i] >= 0;
      for (std::size_t axis = 0; axis < 3; ++axis)
        meets = meets && node.low[axis][i] <= high[axis] && low[axis] <= node.high[axis][i];
      if (!meets) continue;
      if (node.count[i] == 0) stack[top++] = node.child[i];
      for (int k = node.child[i]; k < node.child[i] + node.count[i]; ++k)
        visit(tree.order[static_cast<std::size_t>(k)]);
    }
  }
}

}  // namespace bespoke
