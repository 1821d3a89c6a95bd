#pragma once

#include <vector>

#include "bespoke/pattern/flattening/flat_faces.h"
#include "bespoke/pattern/piece.h"

namespace bespoke {

/// Lowers the symmetric Dirichlet energy Σ area (|J|² + |J⁻¹|²) of a flat piece (2×n, without flipped faces),
/// which keeps faces from collapsing where lengths cannot be kept: reweighted local and global steps
/// (Rabinovich, Poranne, Panozzo and Sorkine-Hornung 2017, with one weight a face), of which none flips a
/// face.
Eigen::Matrix2Xd barrier_descent(const Piece& piece, const std::vector<RestFace>& rest,
                                 Eigen::Matrix2Xd flat);

}  // namespace bespoke
