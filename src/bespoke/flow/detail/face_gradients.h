#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What one task of a parallel loop over faces takes.
inline constexpr std::size_t faces_per_chunk = 4096;

/// The affine map of every face onto its fitted counterpart.
struct FaceGradients {
  /// 3×3m, three columns per face: the matrix that takes the source face's edges to the fitted ones, and its
  /// unit normal to the fitted unit normal times the square root of the ratio of areas (as in Eq. 18).
  /// Identity for faces without area in the source.
  Points matrices;
  Eigen::VectorXd areas;  ///< of the source faces, squared mesh units; 0 where there is no gradient

  Matrix3 of(Eigen::Index face) const { return matrices.middleCols<3>(3 * face); }
  Eigen::Index faces() const { return areas.size(); }
};

/// fitted: 3×n, mesh units.
FaceGradients face_gradients(const TriangleMesh& source, const Points& fitted);

}  // namespace bespoke
