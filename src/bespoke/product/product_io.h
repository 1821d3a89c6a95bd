#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Polygons of fewer than three corners, or that name a vertex twice. A product keeps them; of a model they
/// are left out.
struct DegenerateFaces {
  std::size_t count = 0;
  std::string first;  ///< "a.obj:5: a face names vertex 2 twice"; empty without any
};

/// "2 degenerate faces, which were kept (a.obj:5: a face names vertex 2 twice)".
std::string to_string(const DegenerateFaces& faces);

/// The same of a model: "2 degenerate faces, which were left out (…)".
std::string left_out_text(const DegenerateFaces& faces);

/// The faces of a model or a product. Polygons stay polygons; vertex order, face order and the corners'
/// texture coordinates come back as they were read. Groups, materials and colours do not.
struct Product {
  Points vertices;                 ///< 3×n, mesh units
  std::vector<int> polygon_start;  ///< p+1; polygon k is corners[start[k]] … corners[start[k+1]-1]
  std::vector<int> corners;        ///< vertex indices
  std::vector<int> line_edges;     ///< the ends of the edges of polylines (OBJ, PLY, glTF), by twos
  DegenerateFaces degenerate;
  Eigen::Matrix2Xd texture;  ///< 2×(number of corners), (0, 0) where a face has none; or empty
  bool has_normals = false;  ///< the file carried normals, so the writer writes recomputed ones
  std::string unit;          ///< "m", "mm", … where the file says it (glTF, 3MF), else empty
  Points normals;            ///< 3×n, as they were read: of a PLY or OFF file without faces, or empty
};

/// Reads OBJ, PLY, STL, OFF, glTF (.gltf, .glb) or 3MF by the ending (samples/cookbook/formats.md). Vertices
/// keep their order and are never merged, except in STL and glTF: coincident corners become one vertex,
/// degenerate triangles are dropped. glTF in its bind pose. There may be no faces (a point set). Throws
/// FileError, InvalidInput for an unknown ending, FormatError naming the file and the line (binary: the
/// element) of a bad index, number or corner, and for coordinates beyond the range of floats.
Product read_product(const std::filesystem::path& path);

/// Writes the product as floats or, where these would lose 1e-7 of the bounding box's diagonal, as doubles
/// (STL: floats). Normals, if any, are recomputed; texture coordinates go to OBJ. STL and 3MF hold triangles:
/// polygons become fans; 3MF states the product's unit (default millimetres) and omits degenerate triangles.
/// Atomic. Throws FileError, InvalidInput for an unknown ending, for coordinates beyond floats, for a point
/// set as STL or 3MF, and for units that 3MF lacks.
void write_product(const std::filesystem::path& path, const Product& product);

/// By the ending of the name.
bool can_read_product(const std::filesystem::path& path);
bool can_write_product(const std::filesystem::path& path);

/// ".obj, .ply, … or .glb"
std::string read_product_endings();
std::string written_product_endings();

/// What follows the endings in the message about a file of another ending: how to convert USD, else nothing.
std::string conversion_advice(const std::filesystem::path& path);

/// 2×3m: the first texture coordinates of a glTF file, of the corners of the triangles as read_product orders
/// them, upwards as OBJ has them; (0, 0) where a primitive has none. Empty where none has any, and for other
/// formats, of which read_product gives them. Throws as read_product.
Eigen::Matrix2Xd corner_texture(const std::filesystem::path& path);

/// Polygons as triangle fans about their first corner, in place, without triangles that name a vertex twice.
Faces triangulated(const Product& product);

}  // namespace bespoke
