#pragma once

#include <limits>
#include <vector>

#include "bespoke/elastic/detail/nested_elements.h"

namespace bespoke {

/// What a map may squeeze, relative to none.
struct DistortionBounds {
  double min_determinant = 0.02;     ///< of F, anywhere, > 0
  double max_inverse_squared = 102;  ///< of |F⁻¹|² there
};

/// Of a map x ↦ x + u(x).
struct Distortion {
  double energy = 0;                                                 ///< infinite where a bound does not hold
  double min_determinant = std::numeric_limits<double>::infinity();  ///< over the corners of all finest cells
  /// How stiff each finest cell is, per level: its weight times about the largest second derivative, 4 at
  /// rest; infinite where a bound does not hold. No unit.
  std::vector<std::vector<double>> stiffness;
};

/// ∫ ψ(F) dx over the finest cells by corner quadrature, F = I + ∇u, J = det F ≥ m, s = |F⁻¹|² ≤ S, with
///   ψ = |F|²/2 + |F⁻¹|²/2 − 3 + m (1/(J − m) − 1/(1 − m) + (J − 1)/(1 − m)²) + (s/S)²/(1 − s/S):
/// the symmetric Dirichlet energy (Smith, Schaefer 2015) and two barriers, negligible away from their bounds.
/// All Bézier coefficients of J in a cell are above m (Johnen, Weill, Remacle 2017), also after splits.
/// values: of u, 3×points per level; the energy's gradient is added to `gradients`, sized alike. `scratch`
/// is kept from call to call.
Distortion add_distortion(const NestedElements& elements, const std::vector<Points>& values,
                          const DistortionBounds& bounds, std::vector<Points>& gradients,
                          std::vector<double>& scratch);

/// The finest cells, per level by their place in ElementLevel::finest, at a corner of which a bound does not
/// hold, or within which a Bézier coefficient of J is below a tenth of its bound.
std::vector<std::vector<std::size_t>> cells_beyond(const NestedElements& elements,
                                                   const std::vector<Points>& values,
                                                   const DistortionBounds& bounds);

/// About the diagonal of its Hessian where the finest cells have this stiffness (Distortion): one per point
/// and level, of hat functions of that level (the preconditioner of Bramble, Pasciak and Xu 1990).
std::vector<std::vector<double>> distortion_diagonal(const NestedElements& elements,
                                                     const std::vector<std::vector<double>>& stiffness);

}  // namespace bespoke
