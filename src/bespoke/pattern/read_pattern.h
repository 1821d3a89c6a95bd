#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A piece as `write_pattern` wrote it.
struct WrittenPiece {
  std::string name;
  Points places;  ///< 3×n, on the sheet, millimetres, y up, z = 0
  Faces faces;
  std::vector<int> outline;        ///< vertices along the border
  std::vector<int> product_faces;  ///< of every face the product's triangle
  std::vector<double> strain;      ///< of every face the larger |stretch − 1|
};

struct WrittenPattern {
  std::string path;  ///< for messages
  std::vector<WrittenPiece> pieces;
};

/// Reads the JSON of a pattern. Throws FileError, or FormatError naming the file and what is wrong in it.
WrittenPattern read_pattern(const std::filesystem::path& path);

/// Throws InvalidInput, naming the pattern's file, unless its pieces together are the triangles of `product`,
/// each at least once.
void require_pattern_of(const WrittenPattern& pattern, const std::string& product, Eigen::Index triangles);

}  // namespace bespoke
