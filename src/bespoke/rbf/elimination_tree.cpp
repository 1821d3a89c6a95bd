#include "bespoke/rbf/elimination_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {

RadiusGraph radius_graph(const Points& points, double radius) {
  const PointGrid grid(points, radius);
  const auto count = static_cast<std::size_t>(points.cols());
  RadiusGraph graph;
  graph.start.assign(count + 1, 0);
  constexpr std::size_t grain = 128;
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      grid.for_each_within(points.col(Eigen::Index(i)), radius, [&](int, double) { ++graph.start[i + 1]; });
  });
  for (std::size_t i = 0; i < count; ++i) graph.start[i + 1] += graph.start[i];
  graph.neighbours.resize(graph.start.back());
  graph.distances.resize(graph.start.back());
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::size_t entry = graph.start[i];
      grid.for_each_within(points.col(Eigen::Index(i)), radius, [&](int neighbour, double squared) {
        graph.neighbours[entry] = neighbour;
        graph.distances[entry++] = std::sqrt(squared);
      });
    }
  });
  return graph;
}

namespace {

/// Nested dissection (George 1973): splits sets of points until they are small or no plane separates them.
class Dissection {
 public:
  Dissection(const Points& points, const RadiusGraph& graph, double radius,
             std::vector<EliminationTree::Front>& fronts)
      : points_(points), graph_(graph), radius_(radius), fronts_(fronts), label_(graph.start.size() - 1, 0) {}

  /// Appends the fronts of `set`, children first; returns the index of the last.
  int dissect(std::vector<int> set) {
    constexpr std::size_t largest_leaf = 192;
    EliminationTree::Front front;
    if (set.size() > largest_leaf) {
      Halves halves = split(set);
      if (!halves.left.empty() && !halves.right.empty()) {
        set = std::move(halves.separator);
        front.children[0] = dissect(std::move(halves.left));
        front.children[1] = dissect(std::move(halves.right));
      }
    }
    front.own = std::move(set);
    fronts_.push_back(std::move(front));
    return static_cast<int>(fronts_.size()) - 1;
  }

 private:
  struct Halves {
    std::vector<int> left;
    std::vector<int> right;
    std::vector<int> separator;
  };

  Halves split(std::vector<int>& set) {
    Box box;
    for (const int i : set) box.extend(Vector3(points_.col(i)));
    int axis = 0;
    box.sizes().maxCoeff(&axis);
    const auto before = [&](int a, int b) {
      return std::pair(points_(axis, a), a) < std::pair(points_(axis, b), b);
    };
    const auto middle = set.begin() + std::ptrdiff_t(set.size() / 2);
    std::nth_element(set.begin(), middle, set.end(), before);
    const double plane = points_(axis, *middle);
    const int left_label = ++last_label_;
    const int right_label = ++last_label_;
    for (auto i = set.begin(); i != set.end(); ++i)
      label_[std::size_t(*i)] = i < middle ? left_label : right_label;

    // Points of one half that have a neighbour in the other: taken out, no entry of the matrix joins what is
    // left of the halves. Either half's serve; the fewer make the smaller front.
    const auto touching = [&](auto begin, auto end, int other_label) {
      std::vector<int> result;
      for (auto i = begin; i != end; ++i)
        if (std::abs(points_(axis, *i) - plane) <= radius_ && touches(*i, other_label)) result.push_back(*i);
      return result;
    };
    std::vector<int> of_left = touching(set.begin(), middle, right_label);
    std::vector<int> of_right = touching(middle, set.end(), left_label);
    Halves halves;
    halves.separator = of_left.size() <= of_right.size() ? std::move(of_left) : std::move(of_right);
    constexpr int separator_label = 0;
    for (const int i : halves.separator) label_[std::size_t(i)] = separator_label;
    for (const int i : set) {
      if (label_[std::size_t(i)] == left_label) halves.left.push_back(i);
      if (label_[std::size_t(i)] == right_label) halves.right.push_back(i);
    }
    return halves;
  }

  bool touches(int i, int label) const {
    const auto begin = graph_.neighbours.begin() + std::ptrdiff_t(graph_.start[std::size_t(i)]);
    const auto end = graph_.neighbours.begin() + std::ptrdiff_t(graph_.start[std::size_t(i) + 1]);
    return std::any_of(begin, end, [&](int j) { return label_[std::size_t(j)] == label; });
  }

  const Points& points_;
  const RadiusGraph& graph_;
  double radius_;
  std::vector<EliminationTree::Front>& fronts_;
  std::vector<int> label_;
  int last_label_ = 0;
};

}  // namespace

EliminationTree::EliminationTree(const Points& points, const RadiusGraph& graph, double radius)
    : positions_(graph.start.size() - 1) {
  std::vector<int> all(positions_.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  Dissection(points, graph, radius, fronts_).dissect(std::move(all));
  int next = 0;
  for (const Front& front : fronts_)
    for (const int point : front.own) positions_[std::size_t(point)] = next++;

  std::vector<int> collected_by(positions_.size(), -1);
  int last = 0;
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];
    last += static_cast<int>(front.own.size());
    const auto collect = [&](int point) {
      if (position(point) < last || collected_by[std::size_t(point)] == int(f)) return;
      collected_by[std::size_t(point)] = int(f);
      front.boundary.push_back(point);
    };
    for (const int child : front.children)
      if (child >= 0)
        for (const int point : fronts_[std::size_t(child)].boundary) collect(point);
    for (const int point : front.own)
      for (std::size_t entry = graph.start[std::size_t(point)]; entry < graph.start[std::size_t(point) + 1];
           ++entry)
        collect(graph.neighbours[entry]);
    std::sort(front.boundary.begin(), front.boundary.end(),
              [&](int a, int b) { return position(a) < position(b); });
  }
}

std::size_t EliminationTree::factor_entries() const {
  std::size_t entries = 0;
  for (const Front& front : fronts_) entries += front.own.size() * (front.own.size() + front.boundary.size());
  return entries;
}

std::size_t EliminationTree::peak_bytes() const {
  // Both subtrees may be under way at once; a front holds its update beside its children's.
  std::vector<std::size_t> peak(fronts_.size());
  const auto update_entries = [&](int front) {
    return front < 0
               ? 0
               : fronts_[std::size_t(front)].boundary.size() * fronts_[std::size_t(front)].boundary.size();
  };
  for (std::size_t f = 0; f < fronts_.size(); ++f) {
    const auto [left, right] = fronts_[f].children;
    const std::size_t below = left < 0 ? 0 : peak[std::size_t(left)] + peak[std::size_t(right)];
    peak[f] = std::max(below, update_entries(int(f)) + update_entries(left) + update_entries(right));
  }
  return sizeof(double) * (factor_entries() + (peak.empty() ? 0 : peak.back()));
}

}  // namespace bespoke
