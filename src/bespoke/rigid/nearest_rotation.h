#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// The rotation nearest to a matrix.
struct NearestRotation {
  Matrix3 rotation;  ///< orthonormal, det +1
  double trace =
      0;  ///< tr(Rᵀ M): the sum of the singular values, the least of them negative for a reflection
};

/// The rotation R that maximises tr(Rᵀ M), hence minimises ‖R − M‖ (Frobenius): with M = U S Vᵀ it is
/// U diag(1, 1, ±1) Vᵀ, the last sign such that det R = +1 (Arun, Umeyama, Kabsch). For the cross-covariance
/// M = Σ w y xᵀ of centred pairs it is the least-squares rotation of x onto y. Where M has rank 1 or less, it
/// is one of many.
NearestRotation nearest_rotation(const Matrix3& matrix);

}  // namespace bespoke
