#pragma once

#include <string>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// require_valid, and throws InvalidInput unless some face has an area, as one of a reference model must.
void require_surface(const TriangleMesh& mesh, const std::string& what);

}  // namespace bespoke
