#include "bespoke/anchors/size_ratio.h"

#include <cmath>

#include "bespoke/median.h"

namespace bespoke {
namespace {

bool tells_size(const Anchors& anchors) { return anchors.pairs.size() > 2; }

/// Twice the median distance from the middle: a few places far astray do not decide it.
double typical_size(const Points& places) {
  Vector3 middle;
  for (int axis = 0; axis < 3; ++axis)
    middle[axis] = median({places.row(axis).begin(), places.row(axis).end()});
  const Eigen::VectorXd off = (places.colwise() - middle).colwise().norm();
  return 2 * median({off.begin(), off.end()});
}

}  // namespace

double size_ratio(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target) {
  if (tells_size(anchors)) return typical_size(target_points(anchors)) / typical_size(source_points(anchors));
  return diagonal(target.vertices) / diagonal(source.vertices);
}

bool tells_two_units(double size_ratio) {
  constexpr double largest_size_ratio = 8;
  if (!(size_ratio > 0 && std::isfinite(size_ratio))) return false;
  return size_ratio > largest_size_ratio || 1 / size_ratio > largest_size_ratio;
}

const char* measured_by(const Anchors& anchors) {
  return tells_size(anchors) ? "their anchors" : "their bounding boxes";
}

}  // namespace bespoke
