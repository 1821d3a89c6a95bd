#pragma once

#include <cmath>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/rigid_transform.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke::test {

/// Two small bodies of one make and different connectivity, apart from each other.
struct BodyPair {
  TriangleMesh source;
  TriangleMesh target;
  Anchors anchors;
};

/// A trunk with a waist; `girth` and `height` scale it, no unit.
inline Points body(const Points& on_sphere, double girth, double height) {
  Points result = on_sphere;
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    const double z = on_sphere(2, i);
    const double waist = girth * (1 - 0.25 * std::exp(-8 * z * z));
    result.col(i) = Vector3(waist * on_sphere(0, i), 0.7 * waist * on_sphere(1, i), 2 * height * z);
  }
  return result;
}

inline BodyPair body_pair() {
  BodyPair pair;
  pair.source = shapes::icosphere(3);
  pair.source.vertices = body(pair.source.vertices, 1, 1);
  pair.target = shapes::icosphere(4);
  const RigidTransform away{random_rotation(4), Vector3(6, -1, 2)};
  pair.target.vertices = away * body(random_rotation(8) * pair.target.vertices, 1.15, 0.95);
  const ClosestPointTree on_target(pair.target);
  const Points corners = shapes::icosphere(0).vertices;
  const Points a = body(corners, 1, 1), b = away * body(corners, 1.15, 0.95);
  for (Eigen::Index i = 0; i < a.cols(); ++i)
    pair.anchors.pairs.push_back(
        {"corner " + std::to_string(i), a.col(i), on_target.closest(b.col(i))->point});
  return pair;
}

/// The distances of points from a surface, mesh units.
inline std::vector<double> distances_from(const TriangleMesh& mesh, const Points& x) {
  const ClosestPointTree tree(mesh);
  std::vector<double> result;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    result.push_back(std::sqrt(tree.closest(x.col(i))->squared_distance));
  return result;
}

/// The faces for which keep(centre) holds.
template <class Keep>
TriangleMesh cut(const TriangleMesh& mesh, const Keep& keep) {
  TriangleMesh result{mesh.vertices, Faces(3, 0)};
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    Vector3 centre = Vector3::Zero();
    for (int corner = 0; corner < 3; ++corner) centre += mesh.vertices.col(mesh.faces(corner, face)) / 3;
    if (!keep(centre)) continue;
    result.faces.conservativeResize(3, result.faces.cols() + 1);
    result.faces.rightCols(1) = mesh.faces.col(face);
  }
  return result;
}

}  // namespace bespoke::test
