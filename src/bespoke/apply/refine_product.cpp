#include "bespoke/apply/refine_product.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/digits.h"
#include "bespoke/error.h"
#include "bespoke/mesh/equal_positions.h"

namespace bespoke {
namespace {

// A round divides a chord error by about four.
constexpr int most_rounds = 20;

/// A corner of a polygon.
struct Corner {
  int vertex = 0;
  Eigen::Vector2d texture = Eigen::Vector2d::Zero();
};
using Polygon = std::vector<Corner>;

/// The new vertices of a round: the edges that are split, ascending, the first one's middle first.
class Middles {
 public:
  explicit Middles(int first) : first_(first) {}

  void add(int a, int b) { edges_.emplace_back(a, b); }
  std::size_t size() const { return edges_.size(); }
  const std::pair<int, int>& operator[](std::size_t i) const { return edges_[i]; }

  std::optional<Corner> between(const Corner& a, const Corner& b) const {
    const std::pair edge(std::min(a.vertex, b.vertex), std::max(a.vertex, b.vertex));
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge);
    if (found == edges_.end() || *found != edge) return std::nullopt;
    return Corner{first_ + static_cast<int>(found - edges_.begin()), 0.5 * (a.texture + b.texture)};
  }

 private:
  int first_;
  std::vector<std::pair<int, int>> edges_;
};

/// The corner at which the longest edge of a triangle begins, of those for which `counts(corner)` holds; none
/// where it holds for none.
template <class Counts>
std::optional<std::size_t> longest_edge(const Polygon& triangle, const Points& vertices,
                                        const Counts& counts) {
  std::optional<std::size_t> longest;
  double most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double length =
        (vertices.col(triangle[k].vertex) - vertices.col(triangle[(k + 1) % 3].vertex)).squaredNorm();
    if (!counts(k) || length <= most) continue;
    most = length;
    longest = k;
  }
  return longest;
}

/// A triangle, cut at the middles of its edges, of which the longest is split where any is: no new edge is
/// longer than that one.
void append_triangles(const Polygon& triangle, const Points& vertices, const Middles& middles,
                      std::vector<Polygon>& parts) {
  const auto longest = longest_edge(triangle, vertices, [&](std::size_t k) {
    return middles.between(triangle[k], triangle[(k + 1) % 3]).has_value();
  });
  if (!longest) {
    parts.push_back(triangle);
    return;
  }
  const Corner &a = triangle[*longest], &b = triangle[(*longest + 1) % 3], &c = triangle[(*longest + 2) % 3];
  const auto ab = middles.between(a, b), bc = middles.between(b, c), ca = middles.between(c, a);
  if (bc && ca) {
    parts.insert(parts.end(), {{a, *ab, *ca}, {*ab, b, *bc}, {*ca, *bc, c}, {*ab, *bc, *ca}});
    return;
  }
  if (bc)
    parts.insert(parts.end(), {{*ab, b, *bc}, {*ab, *bc, c}});
  else
    parts.push_back({*ab, b, c});
  if (ca)
    parts.insert(parts.end(), {{a, *ab, *ca}, {*ca, *ab, c}});
  else
    parts.push_back({a, *ab, c});
}

void append_polygon(const Polygon& polygon, const Middles& middles, std::vector<Polygon>& parts) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    result.push_back(polygon[i]);
    if (const auto middle = middles.between(polygon[i], polygon[(i + 1) % polygon.size()]))
      result.push_back(*middle);
  }
  parts.push_back(std::move(result));
}

void split(Product& product, const Middles& middles) {
  const Product old = std::move(product);
  const bool has_texture = old.texture.cols() > 0;
  const Eigen::Index before = old.vertices.cols();
  product = {};
  product.has_normals = old.has_normals;
  product.vertices.resize(3, before + static_cast<Eigen::Index>(middles.size()));
  product.vertices.leftCols(before) = old.vertices;
  for (std::size_t i = 0; i < middles.size(); ++i)
    product.vertices.col(before + static_cast<Eigen::Index>(i)) =
        0.5 * (old.vertices.col(middles[i].first) + old.vertices.col(middles[i].second));
  std::vector<Eigen::Vector2d> texture;
  product.polygon_start.push_back(0);
  for (std::size_t p = 0; p + 1 < old.polygon_start.size(); ++p) {
    Polygon polygon;
    for (int k = old.polygon_start[p]; k < old.polygon_start[p + 1]; ++k)
      polygon.push_back({old.corners[static_cast<std::size_t>(k)],
                         has_texture ? Eigen::Vector2d(old.texture.col(k)) : Eigen::Vector2d::Zero()});
    std::vector<Polygon> parts;
    if (polygon.size() == 3)
      append_triangles(polygon, old.vertices, middles, parts);
    else
      append_polygon(polygon, middles, parts);
    for (const Polygon& part : parts) {
      for (const Corner& corner : part) {
        product.corners.push_back(corner.vertex);
        if (has_texture) texture.push_back(corner.texture);
      }
      product.polygon_start.push_back(static_cast<int>(product.corners.size()));
    }
  }
  if (has_texture)
    product.texture = Eigen::Map<const Eigen::Matrix2Xd>(texture.front().data(), 2,
                                                         static_cast<Eigen::Index>(texture.size()));
}

/// The edges that miss the length, and of every triangle that has one its longest edge. What edges at the
/// same places ask for holds for all of them.
Middles chosen_edges(const Product& product, const Eigen::Matrix2Xi& edges, const Eigen::VectorXd& errors,
                     double length) {
  const std::vector<int> place = first_at_equal_position(product.vertices);
  const auto key = [&](int a, int b) {
    const int p = place[static_cast<std::size_t>(a)], q = place[static_cast<std::size_t>(b)];
    return std::pair(std::min(p, q), std::max(p, q));
  };
  std::set<std::pair<int, int>> chosen;
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    if (errors[i] > length) chosen.insert(key(edges(0, i), edges(1, i)));
  for (bool has_grown = !chosen.empty(); has_grown;) {
    has_grown = false;
    for (std::size_t p = 0; p + 1 < product.polygon_start.size(); ++p) {
      const int begin = product.polygon_start[p];
      if (product.polygon_start[p + 1] - begin != 3) continue;
      Polygon triangle(3);
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k].vertex =
            place[static_cast<std::size_t>(product.corners[static_cast<std::size_t>(begin) + k])];
      const auto edge = [&](std::size_t k) {
        return key(triangle[k % 3].vertex, triangle[(k + 1) % 3].vertex);
      };
      if (!chosen.contains(edge(0)) && !chosen.contains(edge(1)) && !chosen.contains(edge(2))) continue;
      has_grown =
          chosen.insert(edge(*longest_edge(triangle, product.vertices, [](std::size_t) { return true; })))
              .second ||
          has_grown;
    }
  }
  Middles middles(static_cast<int>(product.vertices.cols()));
  for (Eigen::Index i = 0; i < edges.cols(); ++i)
    if (chosen.contains(key(edges(0, i), edges(1, i)))) middles.add(edges(0, i), edges(1, i));
  return middles;
}

/// Vertices that the edges end with where the map is smooth: as many pieces divide a chord error by their
/// number's square.
double expected_vertices(Eigen::Index vertices, const Eigen::VectorXd& errors, double length) {
  return static_cast<double>(vertices) +
         (errors.array() > length).select((errors / length).cwiseSqrt().array() - 1, 0).sum();
}

std::string in_short(double value) { return in_digits(value, 4); }

}  // namespace

RefinedProduct refine_product(Product product, const ImageOfPoints& image, double length,
                              std::size_t most_vertices) {
  if (!(length > 0))
    throw InvalidInput("a product cannot be refined to a chord error of " + in_short(length) +
                       "; it must be positive");
  RefinedProduct refined;
  refined.product = std::move(product);
  for (int round = 0;; ++round) {
    const Points& vertices = refined.product.vertices;
    const Eigen::Matrix2Xi edges = product_edges(refined.product);
    const Eigen::VectorXd errors = chord_errors(vertices, image(vertices), edges, image);
    const Middles middles = chosen_edges(refined.product, edges, errors, length);
    if (middles.size() == 0) break;
    if (round == most_rounds)
      throw InvalidInput("a chord error of " + in_short(length) + " is not met after " +
                         std::to_string(most_rounds) + " halvings of edges; " + in_short(errors.maxCoeff()) +
                         " is left, ask for less");
    const double needed = std::max(static_cast<double>(vertices.cols()) + static_cast<double>(middles.size()),
                                   expected_vertices(vertices.cols(), errors, length));
    if (needed > static_cast<double>(most_vertices))
      throw InvalidInput("a chord error of " + in_short(length) + " would take more than " +
                         std::to_string(most_vertices) + " vertices; the largest is " +
                         in_short(errors.maxCoeff()) + ", ask for less");
    refined.splits += middles.size();
    split(refined.product, middles);
  }
  refined.chord = worst_chord(refined.product, image);
  return refined;
}

}  // namespace bespoke
