#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/product/product_io.h"

namespace bespoke {

/// An edge of a product stays straight where the map would bend it: the distance between the middle of its
/// image and the image of its middle.
struct ChordError {
  std::size_t edges = 0;
  double length = 0;                ///< the largest of all edges, mesh units
  Vector3 place = Vector3::Zero();  ///< the middle of that edge in the product
};

/// "chord error at most 0.12, at (1, 2, 3), of 300 edges".
std::string to_string(const ChordError& error);

/// Every edge of the polygons and the lines once: 2×m vertex numbers, the smaller one first, ascending.
Eigen::Matrix2Xi product_edges(const Product& product);

/// For every vertex of a product the number of the part that it belongs to and that keeps its shape, or -1.
/// Empty: there are no parts.
using VertexParts = std::vector<int>;

/// For every edge (2×m) whether it lies, by its place, on a polygon all of whose corners are of one part, or
/// on a line between two such vertices: it keeps straight.
std::vector<bool> stiff_edges(const Product& product, const Eigen::Matrix2Xi& edges,
                              const VertexParts& parts);

/// Of each edge (2×m), under the map alone, but zero where it is stiff.
Eigen::VectorXd chord_errors(const Points& vertices, const Eigen::Matrix2Xi& edges,
                             const std::vector<bool>& is_stiff, const ImageOfPoints& image);

/// Of all edges of a product's polygons and lines; zero without any.
ChordError worst_chord(const Product& product, const ImageOfPoints& image, const VertexParts& parts = {});

}  // namespace bespoke
