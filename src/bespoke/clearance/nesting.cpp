#include "bespoke/clearance/nesting.h"

#include <algorithm>
#include <utility>

#include "bespoke/clearance/obstacle.h"

namespace bespoke {
namespace {

// Of the places near each other: fewer on the one side, and the two interleave.
constexpr double min_share = 0.6;

/// Vertices of `product` above `below`, within its reach.
std::size_t count_above(const TriangleMesh& product, const Obstacle& below) {
  const std::vector<double> required = below.planes(product.vertices).required;
  return static_cast<std::size_t>(
      std::count_if(required.begin(), required.end(), [](double value) { return value > 0; }));
}

}  // namespace

std::vector<std::size_t> nesting_order(const std::vector<TriangleMesh>& products, double source_diagonal) {
  const std::size_t count = products.size();
  const ModelSizes sizes{source_diagonal, source_diagonal};
  std::vector<std::vector<std::size_t>> above(count, std::vector<std::size_t>(count, 0));
  for (std::size_t below = 0; below < count; ++below) {
    if (products[below].faces.cols() == 0) continue;
    const Obstacle layer = layer_obstacle("", products[below], products[below].vertices, sizes);
    for (std::size_t over = 0; over < count; ++over)
      if (over != below) above[over][below] = count_above(products[over], layer);
  }
  const auto lies_over = [&](std::size_t a, std::size_t b) {
    const auto over = static_cast<double>(above[a][b]), under = static_cast<double>(above[b][a]);
    return over > min_share * (over + under);
  };
  std::vector<std::size_t> order;
  std::vector<char> is_placed(count, 0);
  while (order.size() < count) {
    // The first with none left under it; of a circle the first.
    std::size_t next = count;
    for (std::size_t i = 0; i < count && next == count; ++i) {
      if (is_placed[i]) continue;
      bool is_free = true;
      for (std::size_t j = 0; j < count; ++j)
        is_free = is_free && (j == i || is_placed[j] || !lies_over(i, j));
      if (is_free) next = i;
    }
    if (next == count)
      next = static_cast<std::size_t>(std::find(is_placed.begin(), is_placed.end(), 0) - is_placed.begin());
    is_placed[next] = 1;
    order.push_back(next);
  }
  return order;
}

}  // namespace bespoke
