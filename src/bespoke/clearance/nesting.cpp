#include "bespoke/clearance/nesting.h"

#include <algorithm>

#include "bespoke/clearance/obstacle.h"

namespace bespoke {
namespace {

// Of the area above each other: less of it, and the order would be a guess. Of garments over each other it is
// all but hems; a sole and the upper that it is glued to overlap.
constexpr double min_share = 0.9;

/// Of `product` above `below`, within its reach: mesh units squared, of points their number.
double area_above(const TriangleMesh& product, const Obstacle& below) {
  const std::vector<double> required = below.planes(product.vertices).required;
  const Eigen::VectorXd areas =
      product.faces.cols() > 0 ? vertex_areas(product) : Eigen::VectorXd::Ones(product.vertices.cols());
  double area = 0;
  for (std::size_t v = 0; v < required.size(); ++v)
    if (required[v] > 0) area += areas[static_cast<Eigen::Index>(v)];
  return area;
}

}  // namespace

Nesting nesting_of(const std::vector<TriangleMesh>& products, double source_diagonal) {
  const std::size_t count = products.size();
  const ModelSizes sizes{source_diagonal, source_diagonal};
  std::vector<std::vector<double>> above(count, std::vector<double>(count, 0));
  for (std::size_t below = 0; below < count; ++below) {
    if (products[below].faces.cols() == 0) continue;
    const Obstacle layer = layer_obstacle("", products[below], products[below].vertices, sizes);
    for (std::size_t over = 0; over < count; ++over)
      if (over != below) above[over][below] = area_above(products[over], layer);
  }
  const auto lies_over = [&](std::size_t a, std::size_t b) {
    return above[a][b] > min_share * (above[a][b] + above[b][a]);
  };
  Nesting nesting;
  for (std::size_t a = 0; a < count; ++a)
    for (std::size_t b = a + 1; b < count; ++b)
      if (above[a][b] + above[b][a] > 0 && !lies_over(a, b) && !lies_over(b, a))
        nesting.interleaved.emplace_back(a, b);
  std::vector<char> is_placed(count, 0);
  const auto is_free = [&](std::size_t i) {
    for (std::size_t j = 0; j < count; ++j)
      if (j != i && !is_placed[j] && lies_over(i, j)) return false;
    return !is_placed[i];
  };
  while (nesting.order.size() < count) {
    std::size_t next = 0;
    while (next < count && !is_free(next)) ++next;
    if (next == count) {
      nesting.is_circular = true;
      next = static_cast<std::size_t>(std::find(is_placed.begin(), is_placed.end(), 0) - is_placed.begin());
    }
    is_placed[next] = 1;
    nesting.order.push_back(next);
  }
  return nesting;
}

}  // namespace bespoke
