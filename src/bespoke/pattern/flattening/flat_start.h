#pragma once

#include <optional>
#include <vector>

#include "bespoke/pattern/flattening/flat_faces.h"
#include "bespoke/pattern/piece.h"

namespace bespoke {

/// 2×n, of the surface's area: the least squares conformal map with the two ends of the outline fixed that
/// are farthest apart. Empty where it flips a face or its outline crosses itself.
std::optional<Eigen::Matrix2Xd> conformal_start(const Piece& piece, const std::vector<RestFace>& rest);

/// 2×n, of the surface's area: the outline on a circle by its lengths, every other vertex the mean of its
/// neighbours, which is injective for a disk. Throws SolverError where rounding flips a face.
Eigen::Matrix2Xd tutte_start(const Piece& piece, const std::vector<RestFace>& rest);

}  // namespace bespoke
