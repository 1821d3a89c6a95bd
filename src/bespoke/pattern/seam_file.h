#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A name for the piece that holds a vertex, or for the line across the grain through it.
struct VertexName {
  std::string name;
  int vertex = 0;
};

/// A point on the edge from vertex a to vertex b; a vertex where both are one.
struct EdgePoint {
  int a = 0, b = 0;
  double share = 0;  ///< of the way from a to b, 0 … 1
};

/// One seam: along edges, or along a line that crosses faces.
struct SeamCut {
  std::vector<std::array<int, 2>> edges;
  std::vector<EdgePoint> line;  ///< any two successive points lie in one face, which is cut between them
  double ease = 0;              ///< millimetres that the side of the piece `longer` is longer by, ≥ 0
  std::string longer = {};
};

/// Where a product is cut, and what its pieces are called; vertices as in the product's file, from 0.
struct SeamFile {
  std::vector<SeamCut> cuts;
  std::vector<VertexName> names;
  std::vector<VertexName> widths;  ///< lines whose lengths stand in the table of sizes

  std::vector<std::array<int, 2>> edges() const;  ///< of all cuts
};

/// Reads {"seams": [{"edges": [[a, b], …]}, {"path": [a, b, c, …]} or {"line": [a, [b, c, share], …]}, …],
/// "pieces": [{"name": …, "vertex": v}, …], "widths": [{"name": …, "vertex": v}, …]}; vertices are numbered
/// from 1. A path takes the shortest way over edges from each vertex to the next; a line goes straight
/// through faces; a dart is one that begins at the border and ends inside. A seam may have "ease"
/// (millimetres) and "longer" (a piece). Throws FileError, or FormatError naming the file and what is wrong
/// in it.
SeamFile read_seam_file(const std::filesystem::path& path, const TriangleMesh& mesh);

/// The same of the text of such a file.
SeamFile parse_seams(const std::string& text, const std::filesystem::path& path, const TriangleMesh& mesh);

}  // namespace bespoke
