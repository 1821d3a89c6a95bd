#include "bespoke/mesh/mesh_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

TriangleMesh on_vertices(int count, const Faces& faces) { return {Points::Zero(3, count), faces}; }

TEST(MeshEdges, OfAClosedSurfaceObeyEulerAndBelongToTwoFaces) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const MeshEdges table = mesh_edges(sphere);
  EXPECT_EQ(static_cast<Eigen::Index>(table.edges.size()), sphere.vertices.cols() + sphere.faces.cols() - 2);
  for (const MeshEdge& edge : table.edges) {
    EXPECT_EQ(edge.forward, 1);
    EXPECT_EQ(edge.backward, 1);
  }
  EXPECT_EQ(boundary_edges(sphere, table).cols(), 0);
}

TEST(MeshEdges, AreSortedAndJoinTheCornersOfTheirFaces) {
  const TriangleMesh square = shapes::square_grid(3);
  const MeshEdges table = mesh_edges(square);
  for (std::size_t i = 0; i < table.edges.size(); ++i) {
    EXPECT_LT(table.edges[i].a, table.edges[i].b);
    if (i > 0) {
      EXPECT_LT(std::pair(table.edges[i - 1].a, table.edges[i - 1].b),
                std::pair(table.edges[i].a, table.edges[i].b));
    }
  }
  for (Eigen::Index face = 0; face < square.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k) {
      const MeshEdge& edge = table.edges[static_cast<std::size_t>(table.of_face(k, face))];
      const int from = square.faces(k, face), to = square.faces((k + 1) % 3, face);
      EXPECT_EQ(std::pair(edge.a, edge.b), std::pair(std::min(from, to), std::max(from, to)));
    }
}

TEST(MeshEdges, OfAnOpenSurfaceRunRoundItOnce) {
  const TriangleMesh square = shapes::square_grid(3);
  const Eigen::Matrix2Xi rim = boundary_edges(square, mesh_edges(square));
  EXPECT_EQ(rim.cols(), 12);
  // Each is left by one edge and entered by another, counter-clockwise seen from above.
  Vector3 area = Vector3::Zero();
  for (const auto& edge : rim.colwise())
    area += Vector3(square.vertices.col(edge[0])).cross(Vector3(square.vertices.col(edge[1]))) / 2;
  EXPECT_NEAR(area.z(), 1, 1e-14);
}

TEST(MeshEdges, CountTheFacesAlongAnEdgeByTheirDirection) {
  // Three faces at the edge 0 1, two of them in the same direction.
  const MeshEdges table = mesh_edges(on_vertices(5, Faces{{0, 0, 1}, {1, 1, 0}, {2, 3, 4}}));
  EXPECT_EQ(table.edges[0].forward, 2);
  EXPECT_EQ(table.edges[0].backward, 1);
  EXPECT_FALSE(table.on_boundary(0, 0));
  EXPECT_TRUE(table.on_boundary(0, 1));
}

TEST(MeshEdges, AreNotThoseOfAFaceThatNamesAVertexTwice) {
  const MeshEdges table = mesh_edges(on_vertices(3, Faces{{0, 0}, {1, 0}, {2, 1}}));
  EXPECT_EQ(table.edges.size(), 3u);
  EXPECT_THAT(table.of_face.col(1), Each(static_cast<int>(MeshEdges::none)));
  EXPECT_TRUE(table.on_boundary(0, 0));
  EXPECT_FALSE(table.on_boundary(1, 0));
  EXPECT_TRUE(mesh_edges({}).edges.empty());
}

TEST(VertexAdjacency, ListsNeighboursInOrder) {
  const VertexAdjacency adjacency = vertex_adjacency(on_vertices(5, Faces{{2, 1}, {0, 3}, {1, 2}}));
  EXPECT_THAT(adjacency.start, ElementsAre(0, 2, 5, 8, 10, 10));
  EXPECT_THAT(adjacency.neighbours, ElementsAre(1, 2, 0, 2, 3, 0, 1, 3, 1, 2));
}

TEST(VertexAdjacency, OfNothingIsEmpty) { EXPECT_THAT(vertex_adjacency({}).start, ElementsAre(0)); }

TEST(BoundaryVertices, AreThoseOfTheRim) {
  EXPECT_THAT(boundary_vertices(shapes::square_grid(2)), ElementsAre(1, 1, 1, 1, 0, 1, 1, 1, 1));
  EXPECT_THAT(boundary_vertices(shapes::cube()), Each(0));
}

}  // namespace
}  // namespace bespoke
