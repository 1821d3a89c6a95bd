#include "bespoke/topology/mesh_components.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh two_parts() {
  return shapes::joined(shapes::cube(2),
                        shapes::moved(shapes::icosphere(1), {Matrix3::Identity(), {5, 0, 0}}));
}

TEST(MeshComponents, AreCountedInTheOrderOfTheirVertices) {
  const TriangleMesh cube = shapes::cube(2), ball = shapes::icosphere(1);
  const MeshComponents components = mesh_components(two_parts());
  ASSERT_EQ(components.count(), 2);
  EXPECT_EQ(components.vertices, (std::vector<int>{int(cube.vertices.cols()), int(ball.vertices.cols())}));
  EXPECT_EQ(components.faces, (std::vector<int>{int(cube.faces.cols()), int(ball.faces.cols())}));
  EXPECT_EQ(components.of_vertex.front(), 0);
  EXPECT_EQ(components.of_vertex.back(), 1);
  EXPECT_EQ(components.of_face.front(), 0);
  EXPECT_EQ(components.of_face.back(), 1);
}

TEST(MeshComponents, HaveNoVertexThatNoFaceUses) {
  TriangleMesh mesh = shapes::triangle();
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols(1).setZero();
  const MeshComponents components = mesh_components(mesh);
  EXPECT_EQ(components.count(), 1);
  EXPECT_EQ(components.of_vertex.back(), MeshComponents::none);
  EXPECT_EQ(mesh_components({Points(3, 4), Faces(3, 0)}).count(), 0);
}

TEST(KeptComponents, AreTheMeshWithoutTheOthers) {
  const TriangleMesh both = two_parts();
  const PartialMesh ball = kept_components(both, mesh_components(both), {0, 1});
  EXPECT_EQ(ball.mesh.faces, shapes::icosphere(1).faces);
  EXPECT_EQ(ball.mesh.vertices, both.vertices(Eigen::all, ball.vertices));
  EXPECT_EQ(ball.vertices.front(), shapes::cube(2).vertices.cols());
  EXPECT_EQ(kept_components(both, mesh_components(both), {0, 0}).mesh.faces.cols(), 0);
}

}  // namespace
}  // namespace bespoke
