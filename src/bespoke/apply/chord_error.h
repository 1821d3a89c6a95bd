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

/// Every edge of the polygons once: 2×m vertex numbers, the smaller one first, ascending.
Eigen::Matrix2Xi product_edges(const Product& product);

/// Of each edge (2×m), with `images` those of the vertices.
Eigen::VectorXd chord_errors(const Points& vertices, const Points& images, const Eigen::Matrix2Xi& edges,
                             const ImageOfPoints& image);

/// Of all edges of a product's polygons; zero without any.
ChordError worst_chord(const Product& product, const ImageOfPoints& image);

}  // namespace bespoke
