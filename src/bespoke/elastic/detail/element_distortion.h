#pragma once

#include "bespoke/elastic/detail/nested_elements.h"

namespace bespoke {

/// Of a map x ↦ x + u(x).
struct Distortion {
  double energy = 0;           ///< infinite where a corner of a cell is turned over
  double min_determinant = 0;  ///< over the corners of all finest cells
};

/// Symmetric Dirichlet energy ∫ (|F|² + |F⁻¹|²)/2 − 3 dx, F = I + ∇u (Smith and Schaefer 2015), with the corners
/// of the finest cells as quadrature points. values: of u, 3×points per level. Adds the energy's gradient to
/// `gradients`, sized alike. Corner quadrature sees every mode of a trilinear cell.
Distortion add_distortion(const NestedElements& elements, const std::vector<Points>& values,
                          std::vector<Points>& gradients);

/// The diagonal of its Hessian, about, at the state `values`: one per point and level, of hat functions of that
/// level (the preconditioner of Bramble, Pasciak and Xu 1990).
std::vector<std::vector<double>> distortion_diagonal(const NestedElements& elements,
                                                     const std::vector<Points>& values);

}  // namespace bespoke
