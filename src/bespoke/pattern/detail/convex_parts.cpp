#include "bespoke/pattern/detail/convex_parts.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

namespace bespoke {
namespace {

// Of the face, whose corners are (0, 0), (1, 0) and (0, 1): nearer places lie on the chord.
constexpr double on_chord = 1e-9;

Eigen::Vector2d place_in_face(const Vector3& weights) { return weights.tail<2>(); }

double cross_product(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Left of the chord, or 0 on it.
double side_of_chord(const Vector3& weights, const Vector3& from, const Vector3& to) {
  const Eigen::Vector2d along = (place_in_face(to) - place_in_face(from)).normalized();
  const double distance = cross_product(along, place_in_face(weights) - place_in_face(from));
  return std::abs(distance) < on_chord ? 0 : distance;
}

double area_of(const ConvexPart& part, std::size_t first, std::size_t last) {
  double twice = 0;
  const Eigen::Vector2d origin = place_in_face(part[first].weights);
  for (std::size_t k = first + 1; k < last; ++k)
    twice +=
        cross_product(place_in_face(part[k].weights) - origin, place_in_face(part[k + 1].weights) - origin);
  return twice / 2;
}

}  // namespace

void split_parts(std::vector<ConvexPart>& parts, const Vector3& from, const Vector3& to,
                 const std::function<int(const Vector3&)>& crossing) {
  std::map<std::pair<int, int>, int> made;  // by the ends of the side
  std::vector<ConvexPart> result;
  for (const ConvexPart& part : parts) {
    ConvexPart left, right;
    bool has_left = false, has_right = false;
    for (std::size_t k = 0; k < part.size(); ++k) {
      const FaceCorner &a = part[k], &b = part[(k + 1) % part.size()];
      const double of_a = side_of_chord(a.weights, from, to), of_b = side_of_chord(b.weights, from, to);
      has_left = has_left || of_a > 0;
      has_right = has_right || of_a < 0;
      if (of_a >= 0) left.push_back(a);
      if (of_a <= 0) right.push_back(a);
      if (!(of_a * of_b < 0)) continue;
      const Vector3 at = (of_b * a.weights - of_a * b.weights) / (of_b - of_a);
      const auto [entry, is_new] = made.try_emplace(std::minmax(a.vertex, b.vertex), 0);
      if (is_new) entry->second = crossing(at);
      left.push_back({entry->second, at});
      right.push_back({entry->second, at});
    }
    if (has_left && has_right) {
      result.push_back(std::move(left));
      result.push_back(std::move(right));
    } else {
      result.push_back(part);
    }
  }
  parts = std::move(result);
}

std::vector<int> vertices_along(const std::vector<ConvexPart>& parts, const Vector3& from,
                                const Vector3& to) {
  const Eigen::Vector2d way = place_in_face(to) - place_in_face(from);
  std::set<std::pair<double, int>> found;
  std::set<int> known;
  for (const ConvexPart& part : parts)
    for (const FaceCorner& corner : part) {
      const double share = (place_in_face(corner.weights) - place_in_face(from)).dot(way) / way.squaredNorm();
      if (side_of_chord(corner.weights, from, to) == 0 && share > -on_chord && share < 1 + on_chord &&
          known.insert(corner.vertex).second)
        found.emplace(share, corner.vertex);
    }
  std::vector<int> vertices;
  for (const auto& [share, vertex] : found) vertices.push_back(vertex);
  return vertices;
}

void visit_triangles(
    const ConvexPart& part,
    const std::function<void(const FaceCorner&, const FaceCorner&, const FaceCorner&)>& visit) {
  if (part.size() == 3) return visit(part[0], part[1], part[2]);
  std::size_t first = 0, last = 0;
  double best = -1;
  const double whole = area_of(part, 0, part.size() - 1);
  for (std::size_t i = 0; i < part.size(); ++i)
    for (std::size_t j = i + 2; j < part.size() && j - i + 1 < part.size(); ++j) {
      const double area = area_of(part, i, j), smaller = std::min(area, whole - area);
      if (smaller > best) best = smaller, first = i, last = j;
    }
  const auto from = part.begin();
  ConvexPart one(from + static_cast<std::ptrdiff_t>(first), from + static_cast<std::ptrdiff_t>(last) + 1);
  ConvexPart other(from, from + static_cast<std::ptrdiff_t>(first) + 1);
  other.insert(other.end(), from + static_cast<std::ptrdiff_t>(last), part.end());
  visit_triangles(one, visit);
  visit_triangles(other, visit);
}

}  // namespace bespoke
