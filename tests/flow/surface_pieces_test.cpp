#include "bespoke/flow/detail/surface_pieces.h"

#include <gtest/gtest.h>

#include "bespoke/flow/detail/face_gradients.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

Eigen::VectorXd areas_of(const TriangleMesh& mesh) { return face_gradients(mesh, mesh.vertices).areas; }

TEST(SurfacePieces, AreConnectedAndSortedByArea) {
  const TriangleMesh mesh = shapes::joined(shapes::triangle(), shapes::cube());
  const std::vector<SurfacePiece> pieces = surface_pieces(mesh, areas_of(mesh));
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_NEAR(pieces[0].area, 6, 1e-12);
  EXPECT_EQ(pieces[0].vertices.size(), 8u);
  EXPECT_EQ(pieces[0].faces.size(), 12u);
  EXPECT_EQ(pieces[1].vertices, (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(pieces[1].faces, std::vector<int>{0});
}

TEST(SurfacePieces, AVertexOfNoFaceIsOne) {
  TriangleMesh mesh = shapes::triangle();
  mesh.vertices.conservativeResize(3, 4);
  mesh.vertices.col(3) << 0.2, 0.3, 5;
  const std::vector<SurfacePiece> pieces = surface_pieces(mesh, areas_of(mesh));
  ASSERT_EQ(pieces.size(), 2u);
  EXPECT_EQ(pieces[1].vertices, std::vector<int>{3});
  EXPECT_TRUE(pieces[1].faces.empty());
  const auto links = piece_links(mesh, areas_of(mesh), pieces);
  ASSERT_EQ(links[1].size(), 1u);
  EXPECT_EQ(links[1][0].vertex, 3);
  EXPECT_LT((links[1][0].foot(mesh, mesh.vertices) - Vector3(0.2, 0.3, 0)).norm(), 1e-12);
}

TEST(PieceLinks, LeadToTheNearestLargerPiece) {
  // Small beside middle, middle far from large: the small one belongs to the middle one.
  TriangleMesh large = shapes::cube(3), middle = shapes::cube(2), small = shapes::cube(0.1);
  middle.vertices.colwise() += Vector3(20, 0, 0);
  small.vertices.colwise() += Vector3(22.1, 1, 1);
  const TriangleMesh mesh = shapes::joined(shapes::joined(small, large), middle);
  const Eigen::VectorXd areas = areas_of(mesh);
  const std::vector<SurfacePiece> pieces = surface_pieces(mesh, areas);
  const auto links = piece_links(mesh, areas, pieces);
  ASSERT_EQ(links.size(), 3u);
  EXPECT_TRUE(links[0].empty());
  for (const PieceLink& link : links[1]) EXPECT_NEAR(link.foot(mesh, mesh.vertices).x(), 3, 1e-12);
  for (const PieceLink& link : links[2]) EXPECT_NEAR(link.foot(mesh, mesh.vertices).x(), 22, 1e-12);
}

}  // namespace
}  // namespace bespoke
