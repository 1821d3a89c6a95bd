#include "bespoke/registration/stretched_edges.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/mesh/mesh_edges.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::HasSubstr;

const TriangleMesh even_ball = shapes::icosphere(3);

/// Edges at a vertex.
std::size_t edges_at(int vertex) {
  std::size_t count = 0;
  for (const MeshEdge& edge : mesh_edges(even_ball).edges) count += edge.a == vertex || edge.b == vertex;
  return count;
}

TEST(StretchedEdges, AreNoneOfASimilarity) {
  const Matrix3 turned = Eigen::AngleAxisd(1, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  const Points images = (1000 * turned * even_ball.vertices).colwise() + Vector3(5, 6, 7);
  const StretchedEdges found = stretched_edges(even_ball, images, 1.01);
  EXPECT_EQ(found.count, 0u);
  EXPECT_EQ(to_string(found), "");
}

TEST(StretchedEdges, AreThoseOfASpikeAndOfAPinch) {
  const int spike = 0, pinch = 300;
  Points images = even_ball.vertices;
  images.col(spike) *= 4;
  for (const MeshEdge& edge : mesh_edges(even_ball).edges)
    if (edge.a == pinch || edge.b == pinch) {
      const int other = edge.a == pinch ? edge.b : edge.a;
      images.col(other) = images.col(pinch) + 1e-6 * (images.col(other) - images.col(pinch));
    }
  const StretchedEdges found = stretched_edges(even_ball, images, 10);
  // The spike is 3 long, its edges were.
  double shortest = 1;
  for (const MeshEdge& edge : mesh_edges(even_ball).edges)
    if (edge.a == spike || edge.b == spike)
      shortest = std::min(shortest, (even_ball.vertices.col(edge.a) - even_ball.vertices.col(edge.b)).norm());
  EXPECT_GE(found.max_factor, 3 / shortest);
  // All around the pinch are squeezed to nothing: those at it, and those between its neighbours.
  EXPECT_EQ(found.count, edges_at(spike) + 2 * edges_at(pinch));
  ASSERT_EQ(found.places.size(), 2u);
  const auto near = [&](int vertex) {
    return std::any_of(found.places.begin(), found.places.end(), [&](const Vector3& place) {
      return (place - even_ball.vertices.col(vertex)).norm() < 0.2;
    });
  };
  EXPECT_TRUE(near(spike) && near(pinch));
  EXPECT_THAT(to_string(found), HasSubstr("edges of the source change in length by more than --max-stretch"));
}

TEST(StretchedEdges, AreNoneWhereRemeshingExplainsThem) {
  // An edge of 1e-7 diagonals that comes out 9,000 times as long, and is still within 0.1 % of the diagonal.
  TriangleMesh fine = shapes::square_grid(4);
  const double size = diagonal(fine.vertices);
  Points images = fine.vertices;
  fine.vertices.col(1) = fine.vertices.col(0) + Vector3(1e-7, 0, 0) * size;
  images.col(1) = images.col(0) + Vector3(9e-4, 0, 0) * size;
  std::size_t others = stretched_edges(fine, images, 10).count;
  images.col(1) = images.col(0) + Vector3(2e-3, 0, 0) * size;
  EXPECT_EQ(stretched_edges(fine, images, 10).count, others + 1);
}

}  // namespace
}  // namespace bespoke
