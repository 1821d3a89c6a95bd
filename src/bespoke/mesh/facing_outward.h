#pragma once

#include <optional>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Volume that the surface encloses, mesh units cubed; negative where its faces look inward. Borders are
/// closed by cones to the middle of their vertices.
double signed_volume(const TriangleMesh& mesh);

/// Whether the faces look out of what the surface encloses, or into it; empty where the surface is too flat
/// to enclose anything.
std::optional<bool> faces_outward(const TriangleMesh& mesh);

}  // namespace bespoke
