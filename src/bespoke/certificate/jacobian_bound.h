#pragma once

#include <array>

#include "bespoke/lattice/finest_cells.h"

namespace bespoke {

/// The 27 Bézier coefficients of det ∇ of a trilinear cell, coefficient (i, j, k) at (i·3 + j)·3 + k; those
/// with all of i, j, k ∈ {0, 2} are det at the corners. No unit.
using BezierDeterminant = std::array<double, 27>;

/// Bounds for the 8³ cells of an entry.
struct JacobianBlock {
  std::array<double, leaf_nodes> lower_bound;  ///< of det ∇ over the cell, rounding deducted
  double margin = 0;                           ///< what was deducted
};

/// For the map of a cell's unit coordinates that is linear·x + scale·u(x), u trilinear between the nodes of
/// `sum`. `scaled_error` bounds the error of scale·sum and of linear. Fills `block` for all cells.
void bound_block(const NodeBlock& sum, const Matrix3& linear, double scale, double scaled_error,
                 JacobianBlock& block);

/// The coefficients of one cell of the block.
BezierDeterminant bezier_coefficients(const NodeBlock& sum, int cell, const Matrix3& linear, double scale);

enum class CellVerdict { certified, folded, undecided };

struct DeterminantRange {
  CellVerdict verdict = CellVerdict::undecided;
  double lower_bound = 0;  ///< of det over the cell, when certified
  double value = 0;  ///< a value that det takes in the cell: the first found that is ≤ 0, else the least seen
};

/// Subdivides until the sign is known or differs from zero by less than `margin` on the smallest part.
DeterminantRange decide_cell(const BezierDeterminant& coefficients, double margin);

}  // namespace bespoke
