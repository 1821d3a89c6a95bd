#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// How far two maps take the same points apart.
struct PointDifference {
  Statistics distance;  ///< |Ψ_A(1)(x) − Ψ_B(1)(x)|, mesh units
  /// |E_A(x) − E_B(x)|, in the source frame: without the rigid parts, which differ where a target lies
  /// elsewhere. Mesh units.
  Statistics elastic;
  Vector3 largest = Vector3::Zero();  ///< the x of the largest, source frame; (0, 0, 0) for no points
  Vector3 image_a = Vector3::Zero();  ///< where A takes it
  Vector3 image_b = Vector3::Zero();
};

struct MapDifference {
  /// Points of both bands; where neither map has one, the corners of the box of both sources.
  PointDifference band;
  std::vector<PointDifference> products;  ///< the vertices of products, in their order
  /// Largest distance of the affine parts, in the target frame, over the box of both sources: all that the
  /// maps differ by outside their bands there. Mesh units.
  double affine = 0;
};

/// Random points where the maps' u may be nonzero, `count` of each map: as many of each step and of each
/// level of its pyramid, so that more of them lie where a map is stored finely. Points of later steps are
/// reset through the affine parts of those before. Fewer where a map is affine. 3×n, source frame, mesh
/// units; the same each time, and for A and B those of B and A.
Points points_of_bands(const Asset& a, const Asset& b, std::size_t count);

/// The distance of a map from itself is 0, exactly; A from B as B from A. `products`: 3×n each, source frame.
/// Throws InvalidInput for points that are not finite; Interrupted.
MapDifference map_difference(const Asset& a, const Asset& b, const std::vector<Points>& products,
                             const Progress& progress = {});

}  // namespace bespoke
