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

/// What a level's sum is at the nodes of a leaf. Between nodes that have the values of u, trilinear
/// interpolation errs to one side: by 0 at the nodes and by h² (u_xx + u_yy + u_zz) / 8 in the middle of a
/// cell of size h. With u − (δ²_x + δ²_y + δ²_z) u / 16 at the nodes, δ² the second difference along an axis,
/// it errs as far to either side and, where the three have one sign, half as far (a quasi-interpolant).
/// Affine functions stay exact, nodes where u is zero stay zero, and an axis along which one of the two nodes
/// beside is not in these leaves adds nothing.
std::shared_ptr<const LeafValues> balanced_values(const LeafSurroundings& u);

}  // namespace bespoke
