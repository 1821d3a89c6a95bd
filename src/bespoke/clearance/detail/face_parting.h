#pragma once

#include <optional>

#include "bespoke/types.h"

namespace bespoke {

/// A direction that has two faces apart.
struct Parting {
  Vector3 axis = Vector3::Zero();  ///< unit, from the first face to the second
  double overlap = 0;              ///< of the faces along it, mesh units; negative where they are apart
};

/// The axis of least overlap now among those that had the faces apart before, made of the same normals and
/// edges (separating axes: Gottschalk, Lin, Manocha 1996): so the second stays on its side of the first. A
/// corner a column, mesh units. Empty where no axis had them apart.
std::optional<Parting> parting(const Matrix3& first_before, const Matrix3& second_before,
                               const Matrix3& first_now, const Matrix3& second_now);

}  // namespace bespoke
