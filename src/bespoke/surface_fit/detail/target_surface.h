#pragma once

#include <memory>
#include <optional>
#include <vector>

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
  /// Whether a point on the surface's boundary answers. Usually it does not: there the surface ends, not the
  /// body, and whatever lies beyond would collapse onto the boundary curve.
  bool boundary_answers = false;
};

/// A surface that answers closest compatible points. Thread-safe.
class TargetSurface {
 public:
  /// Throws InvalidInput as ClosestPointTree.
  explicit TargetSurface(TriangleMesh mesh);

  /// The same faces with other vertices (3×n, mesh units).
  TargetSurface moved(Points vertices) const;

  /// Closest point within the limits; empty when there is none, when it lies on the boundary and that does
  /// not answer, or when `normal` (unit) is zero.
  std::optional<SurfaceMatch> match(const Vector3& x, const Vector3& normal, const MatchLimits& limits) const;

  /// Closest point, whatever the normals and on the boundary too.
  SurfacePoint closest(const Vector3& x) const;

  const TriangleMesh& mesh() const { return mesh_; }
  const Points& normals() const { return normals_; }       ///< 3×n, unit or zero, per vertex
  const Eigen::VectorXd& areas() const { return areas_; }  ///< n, a third of the adjacent faces' areas
  /// 2×e: the vertices of the edges of exactly one face, along the face.
  const Eigen::Matrix2Xi& boundary_edges() const { return boundary_->edges; }

 private:
  struct Boundary {
    MeshEdges table;
    Eigen::Matrix2Xi edges;
    std::vector<char> vertices;
  };
  TargetSurface(TriangleMesh mesh, ClosestPointTree tree, std::shared_ptr<const Boundary> boundary);
  static std::shared_ptr<const Boundary> boundary_of(const TriangleMesh& mesh);
  bool on_boundary(const SurfacePoint& found) const;

  TriangleMesh mesh_;
  ClosestPointTree tree_;
  Points normals_;
  Eigen::VectorXd areas_;
  std::shared_ptr<const Boundary> boundary_;
};

/// Distances of points (3×n, mesh units) from the surface, whatever the normals.
Statistics distances(const TargetSurface& surface, const Points& points);

}  // namespace bespoke
