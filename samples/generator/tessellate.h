#pragma once

#include <optional>

#include "anatomy.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "remesh.h"

namespace bespoke {

struct Tessellation {
  double lattice_spacing = 1;                      ///< cm; finer than the thinnest part
  Matrix3 lattice_rotation = Matrix3::Identity();  ///< another rotation gives another connectivity
  RemeshOptions edges;
};

/// Triangles on the zero surface of `field` around `inside`, as far as `cut` (if given) is negative.
TriangleMesh tessellate(const Anatomy& shape, const std::optional<Field>& cut, const Tessellation& how);

/// Rotation by the angle (degrees) about an axis that no lattice has.
Matrix3 oblique_rotation(double degrees);

}  // namespace bespoke
