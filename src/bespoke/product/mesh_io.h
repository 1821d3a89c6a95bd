#pragma once

#include <filesystem>
#include <string>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Reads a reference model; formats, order, precision and errors as read_product. Polygons become triangle
/// fans in place; degenerate faces are left out.
TriangleMesh read_triangle_mesh(const std::filesystem::path& path);

/// Formats, digits and errors as write_product. Atomic. `unit`: of the vertices, for formats that say it.
void write_triangle_mesh(const std::filesystem::path& path, const TriangleMesh& mesh,
                         const std::string& unit = "");

}  // namespace bespoke
