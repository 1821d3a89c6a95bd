#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

struct BoxTree;

/// A point on a surface.
struct SurfacePoint {
  Vector3 point;  ///< mesh units
  int face = 0;
  /// Weights of the face's three vertices, ≥ 0, sum 1. On an edge or at a corner the others are exactly 0.
  Vector3 barycentric;
  double squared_distance = std::numeric_limits<double>::infinity();  ///< from the query
};

/// Where a point of a surface is when the surface's vertices are here (3×n): it goes with its face.
Vector3 carried(const SurfacePoint& point, const Faces& faces, const Points& vertices);

/// Which points of the surface a query may return.
struct ClosestPointQuery {
  double max_distance = std::numeric_limits<double>::infinity();  ///< mesh units
  /// Only faces whose unit normal n satisfies n · normal > min_cosine count (the paper's compatible points,
  /// IV.C: within 90° is min_cosine 0). Without a normal every face counts.
  std::optional<Vector3> normal = std::nullopt;
  double min_cosine = 0;
  /// With a normal: counts (normal_length · |n − normal|)² as squared distance too, mesh units, so that of
  /// points about as near the one that faces alike is returned. max_distance and squared_distance include it.
  double normal_length = 0;
};

/// Bounding-volume tree over the triangles of a mesh; for exact closest-point queries. Copies what it
/// needs. Queries are thread-safe and, at equal distance, return the face of least index. Faces without area
/// count too when no normal is given.
/// As fast as Embree's point queries (closest_point_benchmark; tests/accuracy/tuning.md).
class ClosestPointTree {
 public:
  /// Throws InvalidInput when the mesh has no faces or non-finite vertices.
  explicit ClosestPointTree(const TriangleMesh& mesh);
  ~ClosestPointTree();
  ClosestPointTree(ClosestPointTree&&) noexcept;
  ClosestPointTree& operator=(ClosestPointTree&&) noexcept;

  /// For the mesh this was built from with its vertices elsewhere: the same results as a new tree, made in a
  /// fraction of the time, and slower to query the more the mesh was deformed. Throws as the constructor.
  ClosestPointTree moved(const TriangleMesh& mesh) const;
  /// The same where face_normals() of the mesh are known: 3×m.
  ClosestPointTree moved(const TriangleMesh& mesh, const Points& of_faces) const;

  /// Empty when no face satisfies the query. Throws InvalidInput when x is not finite or max_distance is not
  /// at least 0.
  std::optional<SurfacePoint> closest(const Vector3& x, const ClosestPointQuery& query = {}) const;

 private:
  struct Tree;
  ClosestPointTree(BoxTree boxes, const TriangleMesh& mesh, const Points& normals);
  std::unique_ptr<const Tree> tree_;
};

/// Of points (3×k) from the nearest vertex of the mesh, mesh units, which is no nearer than the surface.
/// Quicker than a tree for a few points; empty for more than a hundred, and for a mesh without faces.
std::vector<double> distances_from_vertices(const TriangleMesh& mesh, const Points& points);

}  // namespace bespoke
