#include "bespoke/quality/signed_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"
#include "bespoke/quality/detail/winding_number.h"

namespace bespoke {
namespace {

// Of distances: far above their rounding.
constexpr double slack = 1e-6;

// Vertices at exactly one position get the index of the first of them.
TriangleMesh joined_at_equal_positions(const TriangleMesh& mesh) {
  const std::vector<int> first = first_at_equal_position(mesh.vertices);
  TriangleMesh joined = mesh;
  for (int& vertex : joined.faces.reshaped()) vertex = first[static_cast<std::size_t>(vertex)];
  return joined;
}

/// Whether as many faces run along every edge one way as the other: winding numbers are whole.
bool is_closed(const MeshEdges& table) {
  return std::all_of(table.edges.begin(), table.edges.end(),
                     [](const MeshEdge& edge) { return edge.forward == edge.backward; });
}

// 3×3m, column 3 f + k: the sum of the normals of the faces along the edge opposite to corner k of face f.
// Zero marks an edge without sides: a boundary, or two faces back to back.
Points edge_normals(const TriangleMesh& mesh, const MeshEdges& table, const Points& face_normals) {
  constexpr double back_to_back = 1e-9;  // far above the rounding of a sum of unit normals
  Points of_edges = Points::Zero(3, static_cast<Eigen::Index>(table.edges.size()));
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (const int edge : table.of_face.col(face))
      if (edge != MeshEdges::none) of_edges.col(edge) += face_normals.col(face);
  for (std::size_t edge = 0; edge < table.edges.size(); ++edge) {
    auto normal = of_edges.col(static_cast<Eigen::Index>(edge));
    if (table.edges[edge].on_boundary() || !(normal.norm() > back_to_back)) normal.setZero();
  }
  Points at_sides = Points::Zero(3, 3 * mesh.faces.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int corner = 0; corner < 3; ++corner)
      if (const int edge = table.of_face((corner + 1) % 3, face); edge != MeshEdges::none)
        at_sides.col(3 * face + corner) = of_edges.col(edge);
  return at_sides;
}

}  // namespace

struct SignedDistance::Surface {
  explicit Surface(const TriangleMesh& mesh)
      : tree(mesh),
        joined(joined_at_equal_positions(mesh)),
        normals(face_normals(joined)),
        at_vertices(vertex_normals(joined, normals)),
        vertex_on_boundary(boundary_vertices(joined)),
        winding(mesh) {
    const MeshEdges table = mesh_edges(joined);
    closed = is_closed(table);
    at_edges = edge_normals(joined, table, normals);
  }

  /// max_distance: within which there is one, but for rounding.
  SurfacePoint closest(const Vector3& x, double max_distance) const {
    const std::optional<SurfacePoint> within = tree.closest(x, {.max_distance = max_distance});
    return within ? *within : *tree.closest(x);
  }

  /// behind: of the closest point, by the normal there.
  bool is_inside(const Vector3& x, bool behind) const {
    return closed ? winding.whole(x) != 0 : behind || winding.exceeds_half(x);
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
  WindingNumber winding;
  bool closed = false;
};

SignedDistance::SignedDistance(const TriangleMesh& mesh) : surface_(std::make_unique<const Surface>(mesh)) {}
SignedDistance::~SignedDistance() = default;
SignedDistance::SignedDistance(SignedDistance&&) noexcept = default;
SignedDistance& SignedDistance::operator=(SignedDistance&&) noexcept = default;

SignedDistance::Values SignedDistance::operator()(const Points& x) const {
  const auto count = static_cast<std::size_t>(x.cols());
  Values values{std::vector<double>(count), std::vector<char>(count)};
  parallel_for(count, 256, [&](std::size_t begin, std::size_t end) {
    Vector3 before = Vector3::Zero();
    double distance_before = std::numeric_limits<double>::infinity();
    bool is_inside = false;
    for (std::size_t i = begin; i < end; ++i) {
      const Vector3 point = x.col(static_cast<Eigen::Index>(i));
      // Points in turn are often near each other: the surface is no farther than by way of the last one.
      const double step = (point - before).norm();
      const SurfacePoint at = surface_->closest(point, (distance_before + step) * (1 + slack));
      const Vector3 normal = surface_->normal_at(at);
      const double distance = std::sqrt(at.squared_distance);
      // Where none of a closed surface is between, neither is another side of it.
      if (!surface_->closed || i == begin || !(step < std::max(distance, distance_before) * (1 - slack)))
        is_inside = surface_->is_inside(point, (point - at.point).dot(normal) < 0);
      values.distance[i] = is_inside ? -distance : distance;
      values.sided[i] = !normal.isZero(0);
      before = point;
      distance_before = distance;
    }
  });
  return values;
}

}  // namespace bespoke
