#include "bespoke/apply/chord_error.h"

#include <algorithm>
#include <cstdio>
#include <utility>

namespace bespoke {
namespace {

Points middles(const Points& points, const Eigen::Matrix2Xi& edges) {
  Points result(3, edges.cols());
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    result.col(i) = 0.5 * (points.col(edges(0, i)) + points.col(edges(1, i)));
  return result;
}

}  // namespace

std::string to_string(const ChordError& error) {
  char text[200];
  std::snprintf(text, sizeof text, "chord error at most %.4g, at (%.6g, %.6g, %.6g), of %zu edges",
                error.length, error.place[0], error.place[1], error.place[2], error.edges);
  return text;
}

Eigen::Matrix2Xi product_edges(const Product& product) {
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(product.corners.size());
  for (std::size_t polygon = 0; polygon + 1 < product.polygon_start.size(); ++polygon) {
    const auto first = static_cast<std::size_t>(product.polygon_start[polygon]);
    const auto end = static_cast<std::size_t>(product.polygon_start[polygon + 1]);
    for (std::size_t corner = first; corner < end; ++corner) {
      const int a = product.corners[corner], b = product.corners[corner + 1 < end ? corner + 1 : first];
      if (a != b) pairs.emplace_back(std::min(a, b), std::max(a, b));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Eigen::Matrix2Xi edges(2, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    edges.col(static_cast<Eigen::Index>(i)) << pairs[i].first, pairs[i].second;
  return edges;
}

Eigen::VectorXd chord_errors(const Points& vertices, const Points& images, const Eigen::Matrix2Xi& edges,
                             const ImageOfPoints& image) {
  if (edges.cols() == 0) return {};
  return (middles(images, edges) - image(middles(vertices, edges))).colwise().norm();
}

ChordError worst_chord(const Product& product, const ImageOfPoints& image) {
  const Eigen::Matrix2Xi edges = product_edges(product);
  ChordError worst;
  worst.edges = static_cast<std::size_t>(edges.cols());
  if (edges.cols() == 0) return worst;
  Eigen::Index at = 0;
  worst.length = chord_errors(product.vertices, image(product.vertices), edges, image).maxCoeff(&at);
  worst.place = 0.5 * (product.vertices.col(edges(0, at)) + product.vertices.col(edges(1, at)));
  return worst;
}

}  // namespace bespoke
