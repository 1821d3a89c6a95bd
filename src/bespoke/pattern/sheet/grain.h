#pragma once

#include <Eigen/Core>

#include "bespoke/pattern/piece.h"

namespace bespoke {

/// Unit vectors in the plane of a flat piece (flat: 2×n), along which the warp runs: means over the faces by
/// area. Each is (0, 1) where the mean has no direction.

/// Where the chart has its second coordinate: a pattern's layout hangs upright.
Eigen::Vector2d grain_of_charts(const Piece& piece, const Eigen::Matrix2Xd& flat);

/// Where a direction of space runs on the surface: the way that a garment hangs.
Eigen::Vector2d grain_along(const Piece& piece, const Eigen::Matrix2Xd& flat, const Vector3& direction);

/// Where the map takes the grain of the source's piece, which has the same faces.
Eigen::Vector2d carried_grain(const Piece& source, const Eigen::Matrix2Xd& source_flat,
                              const Eigen::Vector2d& source_grain, const Eigen::Matrix2Xd& flat);

}  // namespace bespoke
