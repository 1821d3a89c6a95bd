#pragma once

#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "bespoke/anchors/patch_faces.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/statistics.h"

namespace bespoke {

/// What a point finds on a surface.
struct SurfaceMatch {
  Vector3 point;   ///< mesh units
  Vector3 normal;  ///< unit, interpolated from the vertices
  /// Unit, halfway between `normal` and the query's: a residual along it lets two bent surfaces slide into
  /// each other, where one along `normal` alone takes the target for flat (symmetric point to plane).
  Vector3 halfway;
  int face = 0;
  Vector3 barycentric;
  double agreement = 0;  ///< cosine between the query's normal and `normal`, in [0, 1]
};

/// What counts as compatible with a query.
struct MatchLimits {
  double min_cosine = 0;     ///< between the query's normal and that of the face
  double max_distance = 0;   ///< mesh units
  double normal_length = 0;  ///< mesh units; prefers faces of like normal (ClosestPointQuery)
  /// Whether a point on the surface's boundary is a counterpart. Usually it is not: there the surface ends,
  /// not the body, and whatever lies beyond would collapse onto the boundary curve.
  bool matches_boundary = false;
  /// Only faces of this patch count (FacePatches::none: those of no patch), and where it ends is boundary. A
  /// surface without patches ignores it.
  std::optional<int> patch = std::nullopt;
};

/// A surface with queries of closest compatible points. Thread-safe.
class TargetSurface {
 public:
  /// Throws InvalidInput as ClosestPointTree.
  explicit TargetSurface(TriangleMesh mesh, const FacePatches& patches = {});

  /// The same faces with other vertices (3×n, mesh units).
  TargetSurface moved(Points vertices) const;

  /// Closest point within the limits; empty when there is none, when it lies on the boundary without
  /// `matches_boundary`, or when `normal` (unit) is zero.
  std::optional<SurfaceMatch> match(const Vector3& x, const Vector3& normal, const MatchLimits& limits) const;

  /// Closest point, whatever the normals and on the boundary too.
  SurfacePoint closest(const Vector3& x) const;

  const TriangleMesh& mesh() const { return mesh_; }
  const Points& normals() const { return normals_; }       ///< 3×n, unit or zero, per vertex
  const Eigen::VectorXd& areas() const { return areas_; }  ///< n, a third of the adjacent faces' areas
  /// 2×e: the vertices of the edges of exactly one face, along the face.
  const Eigen::Matrix2Xi& boundary_edges() const { return whole_.extent->boundary_edges; }
  /// The patch that all faces at a vertex are in; empty between patches, and where there are none.
  std::optional<int> patch(Eigen::Index vertex) const;
  bool is_excluded(Eigen::Index vertex) const { return patch(vertex) == FacePatches::excluded; }

 private:
  /// Faces that are searched together, and where they end: what stays as vertices move.
  struct Extent {
    Faces faces;
    std::vector<int> numbers;  // of the faces in the mesh; empty for all of them
    MeshEdges edges;
    Eigen::Matrix2Xi boundary_edges;
    std::vector<char> boundary_vertices;
  };
  struct Part {
    std::shared_ptr<const Extent> extent;
    ClosestPointTree tree;

    Part moved(const TriangleMesh& mesh, const Points& of_faces) const;
    bool ends_at(const SurfacePoint& found) const;
  };
  using VertexPatches = std::vector<std::optional<int>>;

  TargetSurface(TriangleMesh mesh, const Points& of_faces, Part whole, std::map<int, Part> parts,
                std::shared_ptr<const VertexPatches> vertex_patches);
  static Part part_of(const TriangleMesh& mesh, std::vector<int> numbers);
  static std::map<int, Part> parts_of(const TriangleMesh& mesh, const FacePatches& patches);

  TriangleMesh mesh_;
  Part whole_;
  std::map<int, Part> parts_;  // by patch, where there are patches
  std::shared_ptr<const VertexPatches> vertex_patches_;
  Points normals_;
  Eigen::VectorXd areas_;
};

/// Distances of points (3×n, mesh units) from the surface, whatever the normals.
Statistics distances(const TargetSurface& surface, const Points& points);

}  // namespace bespoke
