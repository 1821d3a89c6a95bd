#include "bespoke/surface_fit/matching/target_surface.h"

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

TargetSurface::Part TargetSurface::part_of(const TriangleMesh& mesh, std::vector<int> numbers) {
  const TriangleMesh part{mesh.vertices,
                          numbers.empty() ? mesh.faces : Faces(mesh.faces(Eigen::all, numbers))};
  Extent extent{part.faces, std::move(numbers), mesh_edges(part), {}, {}};
  extent.boundary_edges = bespoke::boundary_edges(part, extent.edges);
  extent.boundary_vertices.assign(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const int vertex : extent.boundary_edges.reshaped())
    extent.boundary_vertices[static_cast<std::size_t>(vertex)] = 1;
  return {std::make_shared<const Extent>(std::move(extent)), ClosestPointTree(part)};
}

std::map<int, TargetSurface::Part> TargetSurface::parts_of(const TriangleMesh& mesh,
                                                           const FacePatches& patches) {
  std::map<int, std::vector<int>> faces;
  for (std::size_t face = 0; face < patches.of_face.size(); ++face)
    if (patches.of_face[face] != FacePatches::excluded)
      faces[patches.of_face[face]].push_back(static_cast<int>(face));
  std::map<int, Part> parts;
  for (auto& [patch, numbers] : faces) parts.emplace(patch, part_of(mesh, std::move(numbers)));
  return parts;
}

TargetSurface::TargetSurface(TriangleMesh mesh, const Points& of_faces, Part whole, std::map<int, Part> parts,
                             std::shared_ptr<const VertexPatches> vertex_patches)
    : mesh_(std::move(mesh)),
      whole_(std::move(whole)),
      parts_(std::move(parts)),
      vertex_patches_(std::move(vertex_patches)),
      normals_(vertex_normals(mesh_, of_faces)),
      areas_(vertex_areas(mesh_)) {}

TargetSurface::TargetSurface(TriangleMesh mesh, const FacePatches& patches)
    : TargetSurface(mesh, face_normals(mesh), part_of(mesh, {}), parts_of(mesh, patches),
                    std::make_shared<const VertexPatches>(bespoke::vertex_patches(mesh, patches))) {}

TargetSurface::Part TargetSurface::Part::moved(const TriangleMesh& mesh, const Points& of_faces) const {
  if (extent->numbers.empty()) return {extent, tree.moved(mesh, of_faces)};
  return {extent, tree.moved({mesh.vertices, extent->faces}, of_faces(Eigen::all, extent->numbers))};
}

TargetSurface TargetSurface::moved(Points vertices) const {
  TriangleMesh mesh{std::move(vertices), mesh_.faces};
  const Points normals = face_normals(mesh);
  std::map<int, Part> parts;
  for (const auto& [patch, part] : parts_) parts.emplace(patch, part.moved(mesh, normals));
  Part whole = whole_.moved(mesh, normals);
  return TargetSurface(std::move(mesh), normals, std::move(whole), std::move(parts), vertex_patches_);
}

std::optional<int> TargetSurface::patch(Eigen::Index vertex) const {
  return vertex_patches_->empty() ? std::nullopt : (*vertex_patches_)[static_cast<std::size_t>(vertex)];
}

bool TargetSurface::Part::ends_at(const SurfacePoint& found) const {
  int zeros = 0;
  for (int k = 0; k < 3; ++k) zeros += found.barycentric[k] <= on_edge ? 1 : 0;
  if (zeros == 0) return false;
  for (int k = 0; k < 3; ++k) {
    const bool at_corner = zeros == 2 && found.barycentric[k] > on_edge;
    if (at_corner) return extent->boundary_vertices[extent->faces(k, found.face)] != 0;
    const bool on_opposite_edge = zeros == 1 && found.barycentric[(k + 2) % 3] <= on_edge;
    if (on_opposite_edge) return extent->edges.on_boundary(found.face, k);
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
  const Part* part = &whole_;
  if (limits.patch && !parts_.empty()) {
    const auto own = parts_.find(*limits.patch);
    if (own == parts_.end()) return std::nullopt;
    part = &own->second;
  }
  std::optional<SurfacePoint> found = part->tree.closest(x, query);
  if (!found || (!limits.matches_boundary && part->ends_at(*found))) return std::nullopt;
  const std::vector<int>& numbers = part->extent->numbers;
  if (!numbers.empty()) found->face = numbers[static_cast<std::size_t>(found->face)];
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
  // Symmetric point to plane (Rusinkiewicz 2019).
  match.halfway = (match.normal + normal).normalized();
  match.agreement = std::clamp(match.normal.dot(normal), 0.0, 1.0);
  return match;
}

SurfacePoint TargetSurface::closest(const Vector3& x) const { return *whole_.tree.closest(x); }

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
