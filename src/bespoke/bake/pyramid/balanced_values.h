#pragma once

#include <array>
#include <memory>

#include "bespoke/lattice/leaf.h"

namespace bespoke {

/// Values at the nodes of a leaf, as PyramidLevel::values_of.
using LeafValues = std::array<float, leaf_floats>;

/// u at the nodes of a leaf and of the six across its faces (by axis, lower before upper; null where there is
/// none).
struct LeafSurroundings {
  const LeafValues* leaf = nullptr;
  std::array<std::array<const LeafValues*, 2>, 3> beside{};
};

/// Of δ² u ≈ h² u″, its second difference along an axis: between nodes that have the values of u, trilinear
/// interpolation errs by 0 to 1/8 of it.
inline constexpr float share_of_difference = 1.0f / 16;

/// What a level's sum is at the nodes of a leaf: the quasi-interpolant u − (δ²_x + δ²_y + δ²_z) u / 16, δ²
/// the second difference along an axis. Trilinear interpolation of u itself errs to one side, by up to h²
/// (u_xx + u_yy + u_zz) / 8 in a cell of size h; this errs half as far to either side. Exact for affine
/// functions; zero stays zero; an axis with a neighbour outside these leaves adds nothing.
std::shared_ptr<const LeafValues> balanced_values(const LeafSurroundings& u);

}  // namespace bespoke
