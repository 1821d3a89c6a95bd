#include "bespoke/surface_fit/detail/target_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <utility>

namespace bespoke {
namespace {

std::uint64_t key_of(int a, int b) {
  return static_cast<std::uint64_t>(std::max(a, b)) << 32 | static_cast<std::uint64_t>(std::min(a, b));
}

// A barycentric weight this small puts the point on the opposite edge.
constexpr double on_edge = 1e-9;

/// Calls visit(face, k) for every edge (k, k+1) that belongs to no other face.
template <class Visit>
void for_each_boundary_edge(const TriangleMesh& mesh, const Visit& visit) {
  std::unordered_map<std::uint64_t, int> faces_of_edge;
  faces_of_edge.reserve(static_cast<std::size_t>(mesh.faces.cols()) * 2);
  for (const auto& face : mesh.faces.colwise())
    for (int k = 0; k < 3; ++k) ++faces_of_edge[key_of(face[k], face[(k + 1) % 3])];
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    for (int k = 0; k < 3; ++k)
      if (faces_of_edge[key_of(mesh.faces(k, f), mesh.faces((k + 1) % 3, f))] == 1) visit(f, k);
}

}  // namespace

Eigen::VectorXd vertex_areas(const TriangleMesh& mesh) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (const auto& face : mesh.faces.colwise()) {
    const Vector3 a = mesh.vertices.col(face[0]);
    const Vector3 ab = mesh.vertices.col(face[1]) - a, ac = mesh.vertices.col(face[2]) - a;
    for (int k = 0; k < 3; ++k) areas[face[k]] += ab.cross(ac).norm() / 6;
  }
  return areas;
}

std::shared_ptr<const TargetSurface::Boundary> TargetSurface::boundary_of(const TriangleMesh& mesh) {
  auto boundary = std::make_shared<Boundary>();
  boundary->face_bits.assign(static_cast<std::size_t>(mesh.faces.cols()), 0);
  boundary->vertices.assign(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  std::vector<Eigen::Vector2i> edges;
  for_each_boundary_edge(mesh, [&](Eigen::Index f, int k) {
    boundary->face_bits[static_cast<std::size_t>(f)] |= static_cast<unsigned char>(1 << k);
    for (const int corner : {k, (k + 1) % 3}) boundary->vertices[mesh.faces(corner, f)] = 1;
    edges.emplace_back(mesh.faces(k, f), mesh.faces((k + 1) % 3, f));
  });
  boundary->edges.resize(2, static_cast<Eigen::Index>(edges.size()));
  for (std::size_t i = 0; i < edges.size(); ++i) boundary->edges.col(static_cast<Eigen::Index>(i)) = edges[i];
  return boundary;
}

TargetSurface::TargetSurface(TriangleMesh mesh, ClosestPointTree tree,
                             std::shared_ptr<const Boundary> boundary)
    : mesh_(std::move(mesh)),
      tree_(std::move(tree)),
      normals_(vertex_normals(mesh_)),
      areas_(vertex_areas(mesh_)),
      boundary_(std::move(boundary)) {}

TargetSurface::TargetSurface(TriangleMesh mesh)
    : TargetSurface(mesh, ClosestPointTree(mesh), boundary_of(mesh)) {}

TargetSurface TargetSurface::moved(Points vertices) const {
  TriangleMesh mesh{std::move(vertices), mesh_.faces};
  ClosestPointTree tree = tree_.moved(mesh);
  return TargetSurface(std::move(mesh), std::move(tree), boundary_);
}

bool TargetSurface::on_boundary(const SurfacePoint& found) const {
  int zeros = 0;
  for (int k = 0; k < 3; ++k) zeros += found.barycentric[k] <= on_edge ? 1 : 0;
  if (zeros == 0) return false;
  for (int k = 0; k < 3; ++k) {
    const bool at_corner = zeros == 2 && found.barycentric[k] > on_edge;
    if (at_corner) return boundary_->vertices[mesh_.faces(k, found.face)] != 0;
    const bool on_opposite_edge = zeros == 1 && found.barycentric[(k + 2) % 3] <= on_edge;
    if (on_opposite_edge) return (boundary_->face_bits[static_cast<std::size_t>(found.face)] >> k & 1) != 0;
  }
  return false;
}

std::optional<SurfaceMatch> TargetSurface::match(const Vector3& x, const Vector3& normal,
                                                 const MatchLimits& limits) const {
  if (!(normal.squaredNorm() > 0)) return std::nullopt;
  ClosestPointQuery query;
  query.max_distance = limits.max_distance;
  query.normal = normal;
  query.min_cosine = limits.min_cosine;
  query.normal_length = limits.normal_length;
  const std::optional<SurfacePoint> found = tree_.closest(x, query);
  if (!found || on_boundary(*found)) return std::nullopt;
  SurfaceMatch match;
  match.point = found->point;
  match.face = found->face;
  match.barycentric = found->barycentric;
  Vector3 interpolated = Vector3::Zero();
  for (int k = 0; k < 3; ++k)
    interpolated += found->barycentric[k] * normals_.col(mesh_.faces(k, found->face));
  const double length = interpolated.norm();
  if (!(length > 0)) return std::nullopt;
  match.normal = interpolated / length;
  match.halfway = (match.normal + normal).normalized();
  match.agreement = std::clamp(match.normal.dot(normal), 0.0, 1.0);
  return match;
}

SurfacePoint TargetSurface::closest(const Vector3& x) const { return *tree_.closest(x); }

}  // namespace bespoke
