#include "bespoke/pattern/self_overlap.h"

#include <algorithm>
#include <numeric>

namespace bespoke {
namespace {

double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// Whether the segments have a point in common; a touch counts.
bool meet(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c,
          const Eigen::Vector2d& d) {
  const double abc = turn(a, b, c), abd = turn(a, b, d), cda = turn(c, d, a), cdb = turn(c, d, b);
  const auto apart = [](double s, double t) { return (s > 0 && t > 0) || (s < 0 && t < 0); };
  if (apart(abc, abd) || apart(cda, cdb)) return false;
  for (int axis = 0; axis < 2; ++axis)
    if (std::max(a[axis], b[axis]) < std::min(c[axis], d[axis]) ||
        std::max(c[axis], d[axis]) < std::min(a[axis], b[axis]))
      return false;
  return true;
}

}  // namespace

std::optional<OutlineCrossing> outline_crossing(const Eigen::Matrix2Xd& places,
                                                const std::vector<int>& outline) {
  const int count = static_cast<int>(outline.size());
  const auto place = [&](int k) -> Eigen::Vector2d {
    return places.col(outline[static_cast<std::size_t>(k % count)]);
  };
  const auto left = [&](int k) { return std::min(place(k).x(), place(k + 1).x()); };
  const auto right = [&](int k) { return std::max(place(k).x(), place(k + 1).x()); };
  std::vector<int> by_left(outline.size());
  std::iota(by_left.begin(), by_left.end(), 0);
  std::sort(by_left.begin(), by_left.end(),
            [&](int i, int j) { return std::pair(left(i), i) < std::pair(left(j), j); });
  std::optional<OutlineCrossing> first;
  std::vector<int> open;  // edges that reach the sweep's place
  for (const int edge : by_left) {
    std::erase_if(open, [&](int other) { return right(other) < left(edge); });
    for (const int other : open) {
      const int apart = (edge - other + count) % count;
      if (apart == 1 || apart == count - 1) continue;
      if (!meet(place(edge), place(edge + 1), place(other), place(other + 1))) continue;
      const OutlineCrossing found{std::min(edge, other), std::max(edge, other)};
      if (!first || found < *first) first = found;
    }
    open.push_back(edge);
  }
  return first;
}

}  // namespace bespoke
