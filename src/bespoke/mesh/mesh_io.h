#pragma once

#include <filesystem>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Reads a reference model from OBJ, PLY (ascii and binary), STL or OFF, by the ending of the name. Vertices
/// keep their order and are never merged (STL, which has no shared vertices, is the exception: corners at
/// exactly the same position become one vertex in order of first use). Polygons become triangle fans in
/// place. Throws FileError when the file cannot be opened, FormatError naming the file and (text formats) the
/// line of a bad index, number or face, InvalidInput for an unknown ending.
TriangleMesh read_triangle_mesh(const std::filesystem::path& path);

/// Writes by the ending of the name, all digits that a float needs to read back unchanged (OBJ: nine
/// significant digits). Atomic: a temporary file beside the target, fsync, rename. Throws FileError,
/// InvalidInput for an unknown ending.
void write_triangle_mesh(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace bespoke
