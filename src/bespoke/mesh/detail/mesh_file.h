#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace bespoke {

enum class MeshFormat { obj, ply, stl, off };

/// By the ending of the name, whatever its case. Throws InvalidInput, naming the endings that are known.
MeshFormat mesh_format(const std::filesystem::path& path);

/// A mesh file, checked, in a form that OpenMesh's readers take without mistake. They skip a vertex whose
/// number is bad (so that all later ones move up), leave out faces that name a vertex twice, never end on
/// an OFF file with comments or a PLY file with half a header, and read the lists that they do not know as
/// something else; so what they are given holds none of that.
struct MeshFile {
  std::string content;
  bool binary = false;       ///< how OpenMesh has to take `content`
  bool normals = false;      ///< the file has vertex normals
  std::size_t vertices = 0;  ///< that `content` holds; not known for STL, whose corners OpenMesh merges
  std::size_t polygons = 0;
};

/// Throws FileError when the file cannot be read, InvalidInput for an unknown ending, FormatError naming the
/// file and the line (text) or the element (binary) of a number that is missing, not a number, not finite or
/// beyond a float's range, of a bad or repeated index, of a face of fewer than three corners, and for a file
/// that is empty, ends early or has no vertices.
MeshFile read_mesh_file(const std::filesystem::path& path);

}  // namespace bespoke
