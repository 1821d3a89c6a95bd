#include "bespoke/alignment/detail/mirror_symmetry.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh ellipsoid() {
  TriangleMesh mesh = shapes::icosphere(3);
  mesh.vertices = Vector3(1, 1.5, 2).asDiagonal() * mesh.vertices;
  return mesh;
}

TEST(MirrorAsymmetry, IsNothingForAnEllipsoidInAnyPosition) {
  TriangleMesh mesh = ellipsoid();
  const Matrix3 rotation = Eigen::AngleAxisd(1.1, Vector3(1, 2, -1).normalized()).toRotationMatrix();
  mesh.vertices = (rotation * mesh.vertices).colwise() + Vector3(5, 6, 7);
  EXPECT_LT(mirror_asymmetry(mesh, make_surface_patches(mesh, 100)), 0.01);
}

TEST(MirrorAsymmetry, SeesAScrew) {
  TriangleMesh mesh = ellipsoid();
  for (auto&& vertex : mesh.vertices.colwise())
    vertex = Eigen::AngleAxisd(0.6 * vertex[2], Vector3::UnitZ()) * Vector3(vertex);
  EXPECT_GT(mirror_asymmetry(mesh, make_surface_patches(mesh, 100)), 0.03);
}

}  // namespace
}  // namespace bespoke
