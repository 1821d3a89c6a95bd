#include "bespoke/surface_fit/detail/target_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// A barycentric weight this small puts the point on the opposite edge: far below what a vertex can be told
// apart by, far above the rounding of the projection onto an edge.
constexpr double on_edge = 1e-9;

}  // namespace

std::shared_ptr<const TargetSurface::Boundary> TargetSurface::boundary_of(const TriangleMesh& mesh) {
  Boundary boundary{mesh_edges(mesh), {}, {}};
  boundary.edges = bespoke::boundary_edges(mesh, boundary.table);
  boundary.vertices.assign(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const int vertex : boundary.edges.reshaped()) boundary.vertices[static_cast<std::size_t>(vertex)] = 1;
  return std::make_shared<const Boundary>(std::move(boundary));
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
    if (on_opposite_edge) return boundary_->table.on_boundary(found.face, k);
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
  if (!found || (!limits.boundary_answers && on_boundary(*found))) return std::nullopt;
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

Statistics distances(const TargetSurface& surface, const Points& points) {
  constexpr std::size_t grain = 64;
  std::vector<double> all(static_cast<std::size_t>(points.cols()));
  parallel_for(all.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      all[i] = std::sqrt(surface.closest(points.col(static_cast<Eigen::Index>(i))).squared_distance);
  });
  return summarize(std::move(all));
}

}  // namespace bespoke
