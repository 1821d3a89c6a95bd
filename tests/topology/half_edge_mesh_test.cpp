#include "bespoke/topology/half_edge_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Three triangles at the edge (0, 1).
TriangleMesh book() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 1, 0, 0, 0,  //
      0, 0, 1, -1, 0,              //
      0, 0, 0, 0, 1;
  mesh.faces.resize(3, 3);
  mesh.faces << 0, 1, 0,  //
      1, 0, 1,            //
      2, 3, 4;
  return mesh;
}

/// Two triangles that share vertex 0 alone.
TriangleMesh bow() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices << 0, 1, 1, -1, -1,  //
      0, 0, 1, 0, -1,                //
      0, 0, 0, 0, 0;
  mesh.faces.resize(3, 2);
  mesh.faces << 0, 0,  //
      1, 3,            //
      2, 4;
  return mesh;
}

TEST(HalfEdgeMesh, ComesBackAsItWas) {
  for (const TriangleMesh& mesh : {shapes::icosphere(2), shapes::square_grid(4), shapes::triangle(),
                                   shapes::joined(shapes::cube(), shapes::square_grid(2))}) {
    const TriangleMesh back = triangle_mesh(half_edge_mesh(mesh));
    EXPECT_EQ(back.vertices, mesh.vertices);
    EXPECT_EQ(back.faces, mesh.faces);
  }
}

TEST(HalfEdgeMesh, LeavesOutDeletedElements) {
  HalfEdgeMesh mesh = half_edge_mesh(shapes::square_grid(3));
  mesh.request_face_status();
  mesh.request_edge_status();
  mesh.request_vertex_status();
  mesh.delete_face(OpenMesh::FaceHandle(0), true);
  const TriangleMesh rest = triangle_mesh(mesh);
  EXPECT_EQ(rest.faces.cols(), 17);
  EXPECT_LT(rest.faces.maxCoeff(), rest.vertices.cols());
}

TEST(HalfEdgeMesh, NamesWhatIsNoManifold) {
  EXPECT_THAT(test::error_message<InvalidInput>([] { half_edge_mesh(book()); }),
              HasSubstr("1 non-manifold edge (the first between vertices 1 and 2)"));
  EXPECT_THAT(test::error_message<InvalidInput>([] { half_edge_mesh(bow()); }),
              HasSubstr("1 non-manifold vertex (the first is vertex 1)"));
  TriangleMesh twice = shapes::triangle();
  twice.faces << 0, 1, 1;
  EXPECT_THAT(test::error_message<InvalidInput>([&] { half_edge_mesh(twice); }), HasSubstr("is face 1"));
  TriangleMesh reversed = shapes::square_grid(1);
  std::swap(reversed.faces(0, 1), reversed.faces(1, 1));
  EXPECT_EQ(non_manifold_places(reversed).edges.size(), 1u);
  EXPECT_TRUE(non_manifold_places(shapes::icosphere(1)).empty());
}

TEST(SplitToManifold, OpensBadPlacesAndNothingElse) {
  for (const TriangleMesh& mesh : {book(), bow()}) {
    const SplitMesh split = split_to_manifold(mesh);
    EXPECT_TRUE(non_manifold_places(split.mesh).empty());
    EXPECT_EQ(split.mesh.faces.cols(), mesh.faces.cols());
    EXPECT_EQ(split.mesh.vertices, mesh.vertices(Eigen::all, split.origins));
    for (Eigen::Index i = 0; i < mesh.faces.size(); ++i)
      EXPECT_EQ(split.origins[static_cast<std::size_t>(split.mesh.faces.reshaped()[i])],
                mesh.faces.reshaped()[i]);
  }
  const TriangleMesh good = shapes::icosphere(2);
  EXPECT_EQ(split_to_manifold(good).mesh.faces, good.faces);
}

// A closed path parts a ball into two discs; a single edge inside a surface opens nothing.
TEST(SplitAtEdges, PartsAlongClosedPaths) {
  const TriangleMesh ball = shapes::icosphere(2);
  const int ring_centre = 0;
  std::vector<std::array<int, 2>> ring;
  for (const auto& face : ball.faces.colwise())
    for (int k = 0; k < 3; ++k)
      if (face[k] == ring_centre) ring.push_back({face[(k + 1) % 3], face[(k + 2) % 3]});
  const SplitMesh split = split_at_edges(ball, ring);
  EXPECT_EQ(boundary_loops(half_edge_mesh(split.mesh)).size(), 2u);
  EXPECT_EQ(split.mesh.vertices.cols(), ball.vertices.cols() + static_cast<Eigen::Index>(ring.size()));
  EXPECT_EQ(split_at_edges(ball, {ring.front()}).mesh.vertices.cols(), ball.vertices.cols());
  EXPECT_THAT(test::error_message<InvalidInput>([&] {
                split_at_edges(ball, {{0, 1}});
              }),
              HasSubstr("share no edge"));
}

TEST(BoundaryLoops, HaveTheSurfaceOnTheLeft) {
  EXPECT_THAT(boundary_loops(half_edge_mesh(shapes::triangle())), ElementsAre(ElementsAre(0, 1, 2)));
  EXPECT_TRUE(boundary_loops(half_edge_mesh(shapes::cube())).empty());
  const std::vector<std::vector<int>> loops = boundary_loops(half_edge_mesh(shapes::square_grid(3)));
  ASSERT_EQ(loops.size(), 1u);
  EXPECT_EQ(loops.front().size(), 12u);
}

}  // namespace
}  // namespace bespoke
