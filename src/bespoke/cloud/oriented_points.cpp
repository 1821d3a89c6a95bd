#include "bespoke/cloud/oriented_points.h"

#include <cmath>
#include <cstdint>

#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

bool is_direction(const Vector3& normal) {
  const double length = normal.stableNorm();
  return length > 0 && std::isfinite(length);
}

void require_directions(const Points& normals, const std::string& what) {
  Eigen::Index bad = 0, first = 0;
  for (Eigen::Index i = normals.cols(); i-- > 0;)
    if (!is_direction(normals.col(i))) {
      ++bad;
      first = i;
    }
  if (bad > 0)
    throw InvalidInput(what + ": " + std::to_string(bad) + " of " + std::to_string(normals.cols()) +
                       " normals are zero or not finite, the first that of point " + std::to_string(first) +
                       "; estimate them anew, or leave these points out");
}

}  // namespace

void require_valid(const OrientedPoints& cloud, const std::string& what) {
  if (cloud.normals.cols() != cloud.points.cols())
    throw InvalidInput(what + ": " + std::to_string(cloud.points.cols()) + " points, but " +
                       std::to_string(cloud.normals.cols()) + " normals");
  if (!(cloud.points.cols() >= min_cloud_points))
    throw InvalidInput(what + ": a point cloud of " + std::to_string(cloud.points.cols()) +
                       " points shows no surface; it needs at least " + std::to_string(min_cloud_points));
  for (Eigen::Index i = 0; i < cloud.points.cols(); ++i)
    if (!cloud.points.col(i).allFinite())
      throw InvalidInput(what + ": point " + std::to_string(i) + " has a coordinate that is not finite");
  const double extent = diagonal(cloud.points);
  if (!(extent > 0)) throw InvalidInput(what + ": all points lie at one place");
  if (!std::isfinite(extent)) throw InvalidInput(what + ": coordinates are too large to compute with");
  require_directions(cloud.normals, what);
}

std::string content_hash(const OrientedPoints& cloud) {
  // As a mesh without faces, which is no model, with normals behind.
  const std::int64_t counts[2] = {cloud.points.cols(), 0};
  Sha256 hash;
  hash.update(counts, sizeof counts);
  for (const Points* columns : {&cloud.points, &cloud.normals}) {
    const Points rounded = columns->cast<float>().cast<double>();
    hash.update(rounded.data(), static_cast<std::size_t>(rounded.size()) * sizeof(double));
  }
  return hash.finish();
}

}  // namespace bespoke
