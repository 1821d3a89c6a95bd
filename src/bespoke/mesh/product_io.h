#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// A mesh that is carried through a mapping: everything but its positions and normals comes back as it was
/// read. Polygons stay polygons; vertex order, texture coordinates and face order are kept.
struct Product {
  Points vertices;                 ///< 3×n, mesh units
  std::vector<int> polygon_start;  ///< p+1; polygon k is corners[start[k]] … corners[start[k+1]-1]
  std::vector<int> corners;        ///< vertex indices
  Eigen::Matrix2Xd texture;        ///< 2×(number of corners), or empty
  bool has_normals = false;        ///< the file carried normals, so the writer writes recomputed ones
};

/// Formats and errors as read_triangle_mesh; a product may have no faces (a point set).
Product read_product(const std::filesystem::path& path);

/// Writes the product with its vertices as they are now; normals are recomputed. Atomic.
void write_product(const std::filesystem::path& path, const Product& product);

}  // namespace bespoke
