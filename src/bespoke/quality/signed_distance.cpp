#include "bespoke/quality/signed_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Vertices at exactly one position get the index of the first of them.
TriangleMesh joined_at_equal_positions(const TriangleMesh& mesh) {
  const auto position = [&](int i) {
    return std::array{mesh.vertices(0, i), mesh.vertices(1, i), mesh.vertices(2, i)};
  };
  std::vector<int> order(static_cast<std::size_t>(mesh.vertices.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return std::pair(position(i), i) < std::pair(position(j), j); });
  std::vector<int> first(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && position(order[k]) == position(order[k - 1]);
    first[static_cast<std::size_t>(order[k])] =
        same ? first[static_cast<std::size_t>(order[k - 1])] : order[k];
  }
  TriangleMesh joined = mesh;
  for (int& vertex : joined.faces.reshaped()) vertex = first[static_cast<std::size_t>(vertex)];
  return joined;
}

struct HalfEdge {
  int a, b;  // a < b
  int face, corner;
};

}  // namespace

struct SignedDistance::Surface {
  explicit Surface(const TriangleMesh& mesh)
      : tree(mesh),
        joined(joined_at_equal_positions(mesh)),
        normals(face_normals(joined)),
        at_vertices(vertex_normals(joined)),
        vertex_on_boundary(boundary_vertices(joined)),
        at_edges(Points::Zero(3, 3 * mesh.faces.cols())) {
    std::vector<HalfEdge> edges;
    for (int face = 0; face < joined.faces.cols(); ++face)
      for (int corner = 0; corner < 3; ++corner) {
        const auto [a, b] =
            std::minmax({joined.faces((corner + 1) % 3, face), joined.faces((corner + 2) % 3, face)});
        if (a != b) edges.push_back({a, b, face, corner});
      }
    const auto key = [](const HalfEdge& edge) { return std::array{edge.a, edge.b, edge.face, edge.corner}; };
    std::sort(edges.begin(), edges.end(),
              [&](const HalfEdge& x, const HalfEdge& y) { return key(x) < key(y); });
    for (auto begin = edges.begin(); begin != edges.end();) {
      auto end = begin;
      Vector3 sum = Vector3::Zero();
      for (; end != edges.end() && end->a == begin->a && end->b == begin->b; ++end)
        sum += normals.col(end->face);
      // Zero marks an edge without sides: a boundary, or two faces back to back.
      if (end - begin < 2 || !(sum.norm() > 1e-9)) sum.setZero();
      for (; begin != end; ++begin) at_edges.col(3 * begin->face + begin->corner) = sum;
    }
  }

  // The weight of an edge's point is exactly zero for the opposite corner, and so on: see ClosestPointTree.
  Vector3 normal_at(const SurfacePoint& at) const {
    std::array<int, 3> positive{};
    int count = 0;
    for (int k = 0; k < 3; ++k)
      if (at.barycentric(k) > 0) positive[static_cast<std::size_t>(count++)] = k;
    if (count == 3) return normals.col(at.face);
    if (count == 2) return at_edges.col(3 * at.face + (3 - positive[0] - positive[1]));
    const int vertex = joined.faces(positive[0], at.face);
    if (vertex_on_boundary[static_cast<std::size_t>(vertex)]) return Vector3::Zero();
    return at_vertices.col(vertex);
  }

  ClosestPointTree tree;
  TriangleMesh joined;
  Points normals, at_vertices;
  std::vector<char> vertex_on_boundary;
  Points at_edges;  // 3×3m, column 3 f + k: of the edge opposite to corner k of face f
};

SignedDistance::SignedDistance(const TriangleMesh& mesh) : surface_(std::make_unique<const Surface>(mesh)) {}
SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

SignedDistance::Values SignedDistance::operator()(const Points& x) const {
  const auto count = static_cast<std::size_t>(x.cols());
  Values values{std::vector<double>(count), std::vector<char>(count)};
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3 point = x.col(static_cast<Eigen::Index>(i));
      const SurfacePoint at = *surface_->tree.closest(point);
      const Vector3 normal = surface_->normal_at(at);
      const double distance = std::sqrt(at.squared_distance);
      values.distance[i] = (point - at.point).dot(normal) < 0 ? -distance : distance;
      values.sided[i] = !normal.isZero(0);
    }
  });
  return values;
}

}  // namespace bespoke
