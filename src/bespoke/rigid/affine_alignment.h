#pragma once

#include "bespoke/types.h"

namespace bespoke {

/// Which directions of the sources count as having no extent, so that the pairs say nothing along them.
enum class FlatDirections {
  of_squared_width_1e_12,  ///< squared widths below 1e-12 of the largest one
  of_rounding,             ///< squared widths that are rounding errors of the others
};

/// The affine map of least squares over point pairs (3×n each, mesh units), of the least change of shape: it
/// is the identity along flat directions, so a flat source keeps its third dimension. It may be singular or
/// turn space over. Throws InvalidInput when the sizes differ or there are no pairs.
AffineMap align_affinely(const Points& source, const Points& target, FlatDirections flat);

}  // namespace bespoke
