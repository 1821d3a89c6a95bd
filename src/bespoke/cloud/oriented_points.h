#pragma once

#include <string>

#include "bespoke/types.h"

namespace bespoke {

/// Points of a surface and the directions in which it faces there: a scan without a mesh.
struct OrientedPoints {
  Points points;   ///< 3×n, mesh units
  Points normals;  ///< 3×n, outwards, of any length above 0
};

/// A cloud of fewer points shows no surface: a few neighbourhoods, most of them cut off by the boundary.
inline constexpr Eigen::Index min_cloud_points = 100;

/// Throws InvalidInput, naming `what` (for instance "target scan.ply"), unless there are at least
/// min_cloud_points, not all at one place, with finite coordinates, and normals that are finite and longer
/// than 0.
void require_valid(const OrientedPoints& cloud, const std::string& what);

/// SHA-256 of points and normals in their order, rounded to floats as content_hash of a mesh does, lower-case
/// hex: names a cloud in an asset, whatever surface is made of it.
std::string content_hash(const OrientedPoints& cloud);

}  // namespace bespoke
