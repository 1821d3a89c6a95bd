#include "bespoke/topology/decimation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/topology/half_edge_mesh.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (const auto& face : mesh.faces.colwise())
    area += 0.5 * (mesh.vertices.col(face[1]) - mesh.vertices.col(face[0]))
                      .cross(mesh.vertices.col(face[2]) - mesh.vertices.col(face[0]))
                      .norm();
  return area;
}

std::size_t count_faces(const TriangleMesh& mesh) { return static_cast<std::size_t>(mesh.faces.cols()); }

std::size_t boundary_count(const TriangleMesh& mesh) {
  const std::vector<MeshEdge> edges = mesh_edges(mesh).edges;
  return static_cast<std::size_t>(
      std::count_if(edges.begin(), edges.end(), [](const MeshEdge& edge) { return edge.on_boundary(); }));
}

TEST(Decimation, KeepsVerticesOfTheWholeAtTheirPlaces) {
  const TriangleMesh ball = shapes::icosphere(4);
  const DecimatedMesh fewer = decimated(ball, 1000);
  EXPECT_EQ(fewer.mesh.vertices, ball.vertices(Eigen::all, fewer.vertices));
  EXPECT_TRUE(std::is_sorted(fewer.vertices.begin(), fewer.vertices.end()));
  EXPECT_EQ(fewer.mesh.faces.maxCoeff() + 1, fewer.mesh.vertices.cols());
}

TEST(Decimation, LeavesAsManyFacesAsItMay) {
  const TriangleMesh ball = shapes::icosphere(3);
  EXPECT_EQ(count_faces(decimated(ball, 500).mesh), 500u);
  EXPECT_EQ(decimated(ball, 5000).mesh.faces.cols(), ball.faces.cols());
}

// The middle of an equilateral triangle of edge e lies e² / 6 below the unit sphere. 500 of them have e² =
// 16 π / (500 √3); edges of twice that length are allowed here.
TEST(Decimation, KeepsAClosedSurfaceClosedAndNear) {
  const TriangleMesh ball = shapes::icosphere(5);
  const TriangleMesh fewer = decimated(ball, 500).mesh;
  EXPECT_TRUE(non_manifold_places(fewer).empty());
  EXPECT_EQ(boundary_count(fewer), 0u);
  const ClosestPointTree surface(fewer);
  for (const auto& x : ball.vertices.colwise())
    EXPECT_LT(std::sqrt(surface.closest(x)->squared_distance),
              4 * 16 * 3.14159265 / (500 * std::sqrt(3.0)) / 6);
}

TEST(Decimation, KeepsTheOutlineOfAFlatSheet) {
  const TriangleMesh sheet = shapes::square_grid(30);
  const TriangleMesh fewer = decimated(sheet, 20).mesh;
  EXPECT_LE(fewer.faces.cols(), 20);
  EXPECT_NEAR(area_of(fewer), area_of(sheet), 1e-12);
}

// Right-angled triangles have a ratio of 1 between the squared longest edge and four times the area; slivers
// have none.
TEST(Decimation, LeavesNoSliversOnAFlatSheet) {
  const TriangleMesh fewer = decimated(shapes::square_grid(60), 800).mesh;
  for (const auto& face : fewer.faces.colwise()) {
    const Vector3 a = fewer.vertices.col(face[1]) - fewer.vertices.col(face[0]);
    const Vector3 b = fewer.vertices.col(face[2]) - fewer.vertices.col(face[0]);
    const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()});
    EXPECT_LT(longest, 10 * 2 * a.cross(b).norm());
  }
}

TEST(Decimation, DoesNotDependOnUnitsOrPlace) {
  const TriangleMesh ball = shapes::icosphere(4);
  TriangleMesh far = ball;
  far.vertices = (1024 * ball.vertices).colwise() + Vector3(1 << 20, 0, 0);
  // Positions that far away are rounded to 2⁻³², so that ties between edges are broken otherwise.
  EXPECT_EQ(count_faces(decimated(far, 900).mesh), count_faces(decimated(ball, 900).mesh));
  TriangleMesh large = ball;
  large.vertices *= 1024;
  EXPECT_EQ(decimated(large, 900).vertices, decimated(ball, 900).vertices);
}

TEST(Decimation, ClosesSeams) {
  const TriangleMesh soup = shapes::soup(shapes::icosphere(4));
  const DecimatedMesh fewer = decimated(soup, 1000);
  EXPECT_LE(fewer.mesh.faces.cols(), 1000);
  EXPECT_EQ(boundary_count(fewer.mesh), 0u);
}

// Two sheets that cross at the line x = 1/2, whose vertices they share.
TEST(Decimation, KeepsSheetsTogetherWhereTheyCross) {
  const TriangleMesh flat = shapes::square_grid(10);
  TriangleMesh both = shapes::joined(flat, flat);
  std::vector<int> line;
  for (int vertex = 0; vertex < flat.vertices.cols(); ++vertex) {
    const int other = vertex + static_cast<int>(flat.vertices.cols());
    const Vector3 x = flat.vertices.col(vertex);
    both.vertices.col(other) = Vector3(0.5, x.y(), x.x() - 0.5);
    if (std::abs(x.x() - 0.5) > 1e-9) continue;
    line.push_back(vertex);
    for (int& corner : both.faces.reshaped())
      if (corner == other) corner = vertex;
  }
  ASSERT_FALSE(non_manifold_places(both).empty());
  const DecimatedMesh fewer = decimated(both, 100);
  EXPECT_LT(count_faces(fewer.mesh), 150u);
  for (const int vertex : line)
    EXPECT_TRUE(std::binary_search(fewer.vertices.begin(), fewer.vertices.end(), vertex)) << vertex;
  EXPECT_NEAR(area_of(fewer.mesh), 2, 1e-9);
}

TEST(Decimation, LeavesLoneTrianglesAndDropsWhatIsNone) {
  TriangleMesh lone = shapes::joined(
      shapes::triangle(), shapes::moved(shapes::triangle(), {Matrix3::Identity(), Vector3(5, 0, 0)}));
  EXPECT_EQ(decimated(lone, 1).mesh.faces, lone.faces);
  lone.faces(1, 1) = lone.faces(0, 1);
  EXPECT_EQ(decimated(lone, 1).vertices, (std::vector<int>{0, 1, 2}));
}

}  // namespace
}  // namespace bespoke
