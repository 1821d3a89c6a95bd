#pragma once

#include <filesystem>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Reads a reference model; formats, order, precision and errors as read_product. Polygons become triangle
/// fans in place.
TriangleMesh read_triangle_mesh(const std::filesystem::path& path);

/// Formats, digits and errors as write_product. Atomic.
void write_triangle_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace bespoke
