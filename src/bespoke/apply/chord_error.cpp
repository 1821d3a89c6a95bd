#include "bespoke/apply/chord_error.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "bespoke/mesh/equal_positions.h"

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
  for (std::size_t i = 0; i + 1 < product.line_edges.size(); i += 2)
    if (const int a = product.line_edges[i], b = product.line_edges[i + 1]; a != b)
      pairs.emplace_back(std::min(a, b), std::max(a, b));
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  Eigen::Matrix2Xi edges(2, static_cast<Eigen::Index>(pairs.size()));
  for (std::size_t i = 0; i < pairs.size(); ++i)
    edges.col(static_cast<Eigen::Index>(i)) << pairs[i].first, pairs[i].second;
  return edges;
}

std::vector<bool> stiff_edges(const Product& product, const Eigen::Matrix2Xi& edges,
                              const VertexParts& parts) {
  std::vector<bool> is_stiff(static_cast<std::size_t>(edges.cols()));
  if (parts.empty()) return is_stiff;
  const std::vector<int> place = first_at_equal_position(product.vertices);
  const auto key = [&](int a, int b) -> std::pair<int, int> {
    return std::minmax(place[static_cast<std::size_t>(a)], place[static_cast<std::size_t>(b)]);
  };
  std::vector<std::pair<int, int>> stiff;
  for (std::size_t p = 0; p + 1 < product.polygon_start.size(); ++p) {
    const std::vector<int> polygon(product.corners.begin() + product.polygon_start[p],
                                   product.corners.begin() + product.polygon_start[p + 1]);
    if (polygon.empty()) continue;
    const auto part_of = [&](int vertex) { return parts[static_cast<std::size_t>(vertex)]; };
    const int part = part_of(polygon.front());
    if (part < 0 || !std::all_of(polygon.begin(), polygon.end(), [&](int v) { return part_of(v) == part; }))
      continue;
    for (std::size_t k = 0; k < polygon.size(); ++k)
      stiff.emplace_back(key(polygon[k], polygon[(k + 1) % polygon.size()]));
  }
  for (std::size_t i = 0; i + 1 < product.line_edges.size(); i += 2) {
    const int a = product.line_edges[i], b = product.line_edges[i + 1];
    const int part = parts[static_cast<std::size_t>(a)];
    if (part >= 0 && parts[static_cast<std::size_t>(b)] == part) stiff.emplace_back(key(a, b));
  }
  std::sort(stiff.begin(), stiff.end());
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    is_stiff[static_cast<std::size_t>(i)] =
        std::binary_search(stiff.begin(), stiff.end(), key(edges(0, i), edges(1, i)));
  return is_stiff;
}

Eigen::VectorXd chord_errors(const Points& vertices, const Eigen::Matrix2Xi& edges,
                             const std::vector<bool>& is_stiff, const ImageOfPoints& image) {
  if (edges.cols() == 0) return {};
  Eigen::VectorXd errors =
      (middles(image(vertices), edges) - image(middles(vertices, edges))).colwise().norm();
  for (std::size_t i = 0; i < is_stiff.size(); ++i)
    if (is_stiff[i]) errors[static_cast<Eigen::Index>(i)] = 0;
  return errors;
}

ChordError worst_chord(const Product& product, const ImageOfPoints& image, const VertexParts& parts) {
  const Eigen::Matrix2Xi edges = product_edges(product);
  ChordError worst;
  worst.edges = static_cast<std::size_t>(edges.cols());
  if (edges.cols() == 0) return worst;
  Eigen::Index at = 0;
  worst.length =
      chord_errors(product.vertices, edges, stiff_edges(product, edges, parts), image).maxCoeff(&at);
  worst.place = 0.5 * (product.vertices.col(edges(0, at)) + product.vertices.col(edges(1, at)));
  return worst;
}

}  // namespace bespoke
