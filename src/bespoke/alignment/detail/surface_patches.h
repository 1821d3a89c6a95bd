#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A surface as patches of about equal size, one column or entry per patch. Two sides of a thin part never
/// share a patch.
struct SurfacePatches {
  Points points;                             ///< centroids, mesh units
  Points normals;                            ///< mean normals, unit
  Eigen::VectorXd areas;                     ///< shares of the whole, sum 1
  Eigen::VectorXd open_areas;                ///< shares of what lines no cavity (cavities.h), sum 1
  Eigen::VectorXd curvature;                 ///< mean curvature × `radius`, positive where convex; no unit
  Eigen::VectorXd on_boundary;               ///< 1 where an open boundary of the mesh runs through, else 0
  std::vector<std::vector<int>> neighbours;  ///< across edges of the mesh, ascending, connected as a whole
  std::vector<int> patch_of_vertex;          ///< of the mesh; -1 for vertices in no face
  Vector3 center = Vector3::Zero();          ///< of all points, by open area, mesh units
  Matrix3 axes = Matrix3::Identity();        ///< principal axes, by descending variance; right-handed
  double radius = 0;                         ///< root mean square distance from the centre, mesh units
  double spacing = 0;                        ///< √(area / patches), mesh units

  Eigen::Index size() const { return points.cols(); }
};

/// Longest edge that patches are made of, mesh units; longer ones are halved, so that every patch has
/// vertices.
double longest_edge_of_patches(const TriangleMesh& mesh, int count);

/// About `count` (≥ 4) patches, seeded one by one at the vertex farthest, in place and normal, from all seeds
/// so far. `in_cavity`: n, the vertices that line cavities (cavities.h), or empty for none. Throws
/// InvalidInput unless the mesh is valid and has area.
SurfacePatches make_surface_patches(const TriangleMesh& mesh, int count,
                                    const std::vector<char>& in_cavity = {});

/// The patches of the mirror image (x ↦ −x, faces turned so that normals stay outward).
SurfacePatches mirrored(SurfacePatches patches);

}  // namespace bespoke
