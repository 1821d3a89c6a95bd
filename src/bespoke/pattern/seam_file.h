#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A name for the piece that holds a vertex.
struct PieceName {
  std::string name;
  int vertex = 0;
};

/// Where a product is cut, and what its pieces are called; vertices as in the product's file, from 0.
struct SeamFile {
  std::vector<std::array<int, 2>> edges;
  std::vector<PieceName> names;
};

/// Reads {"seams": [{"edges": [[a, b], …]} or {"path": [a, b, c, …]}, …], "pieces": [{"name": …, "vertex":
/// v}, …]}; vertices are numbered from 1. A path takes the shortest way over edges from each vertex to the
/// next; a dart is one that begins at the border and ends inside. Throws FileError, or FormatError naming the
/// file and what is wrong in it.
SeamFile read_seam_file(const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace bespoke
