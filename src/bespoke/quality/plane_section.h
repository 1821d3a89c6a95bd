#pragma once

#include <optional>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// All points whose product with a normal is that of one of them.
struct Plane {
  Vector3 point;   ///< mesh units
  Vector3 normal;  ///< not zero, any length
};

/// The closed lines in which a plane cuts a surface, the longest first: each 3×n points where it crosses
/// edges, in their order along the line. Vertices at one position count as one. Lines that end at a boundary
/// are left out. Throws InvalidInput for a plane that is none.
std::vector<Points> closed_sections(const TriangleMesh& mesh, const Plane& plane);

/// The closed section that a plane's point means: the longest of those that go round it, or, where none does,
/// the one that comes nearest to it. Empty without a closed section. Throws as closed_sections.
std::optional<Points> section_about_point(const TriangleMesh& mesh, const Plane& plane);

/// Length of the line through 3×n points, mesh units; closed: back to the first.
double line_length(const Points& points, bool closed);

}  // namespace bespoke
