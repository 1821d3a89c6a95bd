#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Polygons of fewer than three corners, or that name a vertex twice. A product keeps them; a model has none.
struct DegenerateFaces {
  std::size_t count = 0;
  std::string first;  ///< "a.obj:5: a face names vertex 2 twice"; empty without any
};

/// "2 degenerate faces, which were kept (a.obj:5: a face names vertex 2 twice)".
std::string to_string(const DegenerateFaces& faces);

/// The faces of a model or a product. Polygons stay polygons; vertex order, face order and the corners'
/// texture coordinates come back as they were read. Groups, materials and colours do not.
struct Product {
  Points vertices;                 ///< 3×n, mesh units
  std::vector<int> polygon_start;  ///< p+1; polygon k is corners[start[k]] … corners[start[k+1]-1]
  std::vector<int> corners;        ///< vertex indices
  std::vector<int> line_edges;     ///< the ends of every edge of the polylines of an OBJ file, by twos
  DegenerateFaces degenerate;
  Eigen::Matrix2Xd texture;  ///< 2×(number of corners), (0, 0) where a face has none; or empty
  bool has_normals = false;  ///< the file carried normals, so the writer writes recomputed ones
  std::string unit;          ///< "m", "mm", … where the file says it (glTF, 3MF), else empty
  Points normals;            ///< 3×n, as they were read: of a PLY or OFF file without faces, or empty
};

/// OBJ, PLY (ascii and binary), STL, OFF, glTF (.gltf, .glb) or 3MF, by the ending of the name, every number
/// as the double that it says. Vertices keep their order and are never merged. STL, which shares no vertices,
/// and glTF, which divides surfaces along the seams of their texture, are the exceptions: corners at exactly
/// the same position become one vertex in order of first use, and a triangle whose corners coincide is left
/// out. Of a glTF file all triangles are read where its nodes show them, without morph targets, in its bind
/// pose; of a 3MF file where its build shows them. A product may have no faces (a point set). Texture
/// coordinates are read from OBJ and PLY. Throws FileError when the file cannot be opened, InvalidInput for
/// an unknown ending, FormatError naming the file and the line (binary: the element) of a bad index, number
/// or corner, and for coordinates beyond the range of floats, in which maps are stored.
Product read_product(const std::filesystem::path& path);

/// Writes the product with its vertices as they are now, as floats (text: the shortest that are read back as
/// the same floats) or, where floats would lose 1e-7 of the bounding box's diagonal, as doubles; STL knows
/// only floats. Normals, where the product had them, are recomputed; texture coordinates are written to OBJ.
/// STL and 3MF hold triangles without texture, so polygons become fans there; 3MF says the product's unit, or
/// millimetres where it has none, and leaves out triangles of which corners coincide. Atomic. Throws
/// FileError, InvalidInput for an unknown ending, for coordinates that a float cannot hold, for a point set
/// as STL or 3MF, and for a 3MF file of a unit that the format does not know.
void write_product(const std::filesystem::path& path, const Product& product);

/// By the ending of the name.
bool can_read_product(const std::filesystem::path& path);
bool can_write_product(const std::filesystem::path& path);

/// ".obj, .ply, … or .glb"
std::string read_product_endings();
std::string written_product_endings();

/// What follows the endings in the message about a file of another ending: how to convert USD, else nothing.
std::string conversion_advice(const std::filesystem::path& path);

/// Polygons as triangle fans about their first corner, in place, without triangles that name a vertex twice.
Faces triangulated(const Product& product);

/// Throws FormatError with the first degenerate face, if there is one: for models.
void require_no_degenerate_faces(const Product& product);

}  // namespace bespoke
