#include "bespoke/apply/detail/refine_product.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

// A round divides a chord error by about four.
constexpr int max_rounds = 20;

/// A corner of a polygon: its vertex, and its number as FaceSplits counts them.
struct Corner {
  int vertex = 0, number = 0;
};
using Polygon = std::vector<Corner>;

/// The new vertices of a round: the edges that are split, ascending, the first one's middle first.
class Middles {
 public:
  explicit Middles(int first) : first_(first) {}

  void add(int a, int b) { edges_.emplace_back(a, b); }
  std::size_t size() const { return edges_.size(); }
  const std::vector<std::pair<int, int>>& edges() const { return edges_; }

  std::optional<int> between(int a, int b) const {
    const std::pair edge(std::min(a, b), std::max(a, b));
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), edge);
    if (found == edges_.end() || *found != edge) return std::nullopt;
    return first_ + static_cast<int>(found - edges_.begin());
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

/// A product whose edges are split in rounds.
class SplitProduct {
 public:
  explicit SplitProduct(Product product)
      : faces_(std::move(product)), texture_(std::move(faces_.texture)), numbers_(faces_.corners.size()) {
    faces_.texture.resize(2, 0);
    std::iota(numbers_.begin(), numbers_.end(), 0);
    splits_.first_part.resize(faces_.polygon_start.size());
    std::iota(splits_.first_part.begin(), splits_.first_part.end(), 0);
    first_new_ = static_cast<int>(numbers_.size());
  }

  /// As they are now, without texture.
  const Product& faces() const { return faces_; }

  void split(const Middles& middles);

  RefinedProduct finish();

 private:
  std::optional<Corner> middle(const Middles& middles, const Corner& a, const Corner& b);
  std::vector<Polygon> triangle_parts(const Polygon& triangle, const Middles& middles);
  Polygon with_middles(const Polygon& polygon, const Middles& middles);
  std::vector<int> split_lines(const Middles& middles) const;

  Product faces_;
  Eigen::Matrix2Xd texture_;  // of the corners before any split
  std::vector<int> numbers_;  // of the corners of faces_
  int first_new_;
  FaceSplits splits_;
};

std::optional<Corner> SplitProduct::middle(const Middles& middles, const Corner& a, const Corner& b) {
  const std::optional<int> vertex = middles.between(a.vertex, b.vertex);
  if (!vertex) return std::nullopt;
  splits_.corners.push_back({a.number, b.number, *vertex});
  return Corner{*vertex, first_new_ + static_cast<int>(splits_.corners.size()) - 1};
}

/// A triangle, cut at the middles of its edges, of which the longest is split where any is: no new edge is
/// longer than that one.
std::vector<Polygon> SplitProduct::triangle_parts(const Polygon& triangle, const Middles& middles) {
  const auto longest = longest_edge(triangle, faces_.vertices, [&](std::size_t k) {
    return middles.between(triangle[k].vertex, triangle[(k + 1) % 3].vertex).has_value();
  });
  if (!longest) return {triangle};
  const Corner &a = triangle[*longest], &b = triangle[(*longest + 1) % 3], &c = triangle[(*longest + 2) % 3];
  const auto ab = middle(middles, a, b), bc = middle(middles, b, c), ca = middle(middles, c, a);
  if (bc && ca) return {{a, *ab, *ca}, {*ab, b, *bc}, {*ca, *bc, c}, {*ab, *bc, *ca}};
  std::vector<Polygon> parts;
  if (bc)
    parts.insert(parts.end(), {{*ab, b, *bc}, {*ab, *bc, c}});
  else
    parts.push_back({*ab, b, c});
  if (ca)
    parts.insert(parts.end(), {{a, *ab, *ca}, {*ca, *ab, c}});
  else
    parts.push_back({a, *ab, c});
  return parts;
}

Polygon SplitProduct::with_middles(const Polygon& polygon, const Middles& middles) {
  Polygon result;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    result.push_back(polygon[i]);
    if (const auto between = middle(middles, polygon[i], polygon[(i + 1) % polygon.size()]))
      result.push_back(*between);
  }
  return result;
}

std::vector<int> SplitProduct::split_lines(const Middles& middles) const {
  std::vector<int> edges;
  for (std::size_t i = 0; i + 1 < faces_.line_edges.size(); i += 2) {
    const int a = faces_.line_edges[i], b = faces_.line_edges[i + 1];
    const std::optional<int> vertex = middles.between(a, b);
    if (vertex)
      edges.insert(edges.end(), {a, *vertex, *vertex, b});
    else
      edges.insert(edges.end(), {a, b});
  }
  return edges;
}

void SplitProduct::split(const Middles& middles) {
  Product next;
  next.has_normals = faces_.has_normals;
  next.degenerate = faces_.degenerate;
  next.unit = faces_.unit;
  const Eigen::Index before = faces_.vertices.cols();
  next.vertices.resize(3, before + static_cast<Eigen::Index>(middles.size()));
  next.vertices.leftCols(before) = faces_.vertices;
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const auto [a, b] = middles.edges()[i];
    next.vertices.col(before + static_cast<Eigen::Index>(i)) =
        0.5 * (faces_.vertices.col(a) + faces_.vertices.col(b));
  }
  splits_.vertices.insert(splits_.vertices.end(), middles.edges().begin(), middles.edges().end());
  next.line_edges = split_lines(middles);
  next.polygon_start.push_back(0);
  std::vector<int> numbers, first_part{0};
  std::size_t original = 0;
  for (std::size_t p = 0; p + 1 < faces_.polygon_start.size(); ++p) {
    Polygon polygon;
    for (auto k = static_cast<std::size_t>(faces_.polygon_start[p]);
         k < static_cast<std::size_t>(faces_.polygon_start[p + 1]); ++k)
      polygon.push_back({faces_.corners[k], numbers_[k]});
    for (const Polygon& part : polygon.size() == 3 ? triangle_parts(polygon, middles)
                                                   : std::vector<Polygon>{with_middles(polygon, middles)}) {
      for (const Corner& corner : part) {
        next.corners.push_back(corner.vertex);
        numbers.push_back(corner.number);
      }
      next.polygon_start.push_back(static_cast<int>(next.corners.size()));
    }
    if (static_cast<int>(p) + 1 < splits_.first_part[original + 1]) continue;
    first_part.push_back(static_cast<int>(next.polygon_start.size()) - 1);
    ++original;
  }
  faces_ = std::move(next);
  numbers_ = std::move(numbers);
  splits_.first_part = std::move(first_part);
}

RefinedProduct SplitProduct::finish() {
  RefinedProduct refined;
  if (texture_.cols() > 0) {
    texture_.conservativeResize(2, first_new_ + static_cast<Eigen::Index>(splits_.corners.size()));
    for (std::size_t i = 0; i < splits_.corners.size(); ++i)
      texture_.col(first_new_ + static_cast<Eigen::Index>(i)) =
          0.5 * (texture_.col(splits_.corners[i].before) + texture_.col(splits_.corners[i].behind));
    faces_.texture = texture_(Eigen::all, numbers_);
  }
  splits_.part_start = faces_.polygon_start;
  splits_.part_corners = std::move(numbers_);
  refined.product = std::move(faces_);
  refined.splits = std::move(splits_);
  return refined;
}

/// The edges that miss the length, and of every triangle that has one its longest edge. What edges at the
/// same places require holds for all of them.
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

/// The middle of a stiff edge belongs to the edge's part. Both edges and middles ascend.
void add_parts_of_middles(const Eigen::Matrix2Xi& edges, const std::vector<bool>& is_stiff,
                          const Middles& middles, VertexParts& parts) {
  Eigen::Index i = 0;
  for (const auto& [a, b] : middles.edges()) {
    while (edges(0, i) != a || edges(1, i) != b) ++i;
    parts.push_back(is_stiff[static_cast<std::size_t>(i)] ? parts[static_cast<std::size_t>(a)] : -1);
  }
}

/// Vertices that the edges end with where the map is smooth: as many pieces divide a chord error by their
/// number's square.
double expected_vertices(Eigen::Index vertices, const Eigen::VectorXd& errors, double length) {
  return static_cast<double>(vertices) +
         (errors.array() > length).select((errors / length).cwiseSqrt().array() - 1, 0).sum();
}

std::string in_short(double value) { return format_number(value, 4); }

}  // namespace

RefinedProduct refine_product(Product product, const ImageOfPoints& image, double length, VertexParts parts,
                              std::size_t max_vertices) {
  if (!(length > 0))
    throw InvalidInput("a product cannot be refined to a chord error of " + in_short(length) +
                       "; it must be positive");
  SplitProduct splitting(std::move(product));
  for (int round = 0;; ++round) {
    const Points& vertices = splitting.faces().vertices;
    const Eigen::Matrix2Xi edges = product_edges(splitting.faces());
    const std::vector<bool> is_stiff = stiff_edges(splitting.faces(), edges, parts);
    const Eigen::VectorXd errors = chord_errors(vertices, edges, is_stiff, image);
    const Middles middles = chosen_edges(splitting.faces(), edges, errors, length);
    if (middles.size() == 0) break;
    if (round == max_rounds)
      throw InvalidInput("a chord error of " + in_short(length) + " is not met after " +
                         std::to_string(max_rounds) + " halvings of edges; " + in_short(errors.maxCoeff()) +
                         " is left, allow a larger one");
    const double needed = std::max(static_cast<double>(vertices.cols()) + static_cast<double>(middles.size()),
                                   expected_vertices(vertices.cols(), errors, length));
    if (needed > static_cast<double>(max_vertices))
      throw InvalidInput("a chord error of " + in_short(length) + " would take more than " +
                         std::to_string(max_vertices) + " vertices; the largest is " +
                         in_short(errors.maxCoeff()) + ", allow a larger one");
    if (!parts.empty()) add_parts_of_middles(edges, is_stiff, middles, parts);
    splitting.split(middles);
  }
  RefinedProduct refined = splitting.finish();
  refined.chord = worst_chord(refined.product, image, parts);
  return refined;
}

}  // namespace bespoke
