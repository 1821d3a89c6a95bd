#include "bespoke/topology/seams.h"

#include <gtest/gtest.h>

#include "bespoke/mesh/mesh_edges.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(JoinedAtSeams, ClosesASoup) {
  const TriangleMesh closed = shapes::icosphere(2);
  const JoinedMesh joined = joined_at_seams(shapes::soup(closed));
  EXPECT_EQ(joined.joined(), static_cast<std::size_t>(closed.faces.size() - closed.vertices.cols()));
  const MeshFindings findings = inspect_mesh(joined.mesh), expected = inspect_mesh(closed);
  EXPECT_EQ(findings.boundary_edges, 0u);
  EXPECT_EQ(findings.non_manifold_edges, 0u);
  EXPECT_EQ(findings.components, expected.components);
  EXPECT_EQ(findings.faces, expected.faces);
}

TEST(JoinedAtSeams, MovesNoCorner) {
  const TriangleMesh cut = shapes::soup(shapes::icosphere(2));
  const JoinedMesh joined = joined_at_seams(cut);
  EXPECT_EQ(joined.mesh.vertices(Eigen::all, joined.of_vertex), cut.vertices);
  EXPECT_EQ(joined.mesh.vertices, cut.vertices(Eigen::all, joined.first));
  for (Eigen::Index i = 0; i < cut.faces.size(); ++i)
    EXPECT_EQ(joined.mesh.faces.reshaped()[i],
              joined.of_vertex[static_cast<std::size_t>(cut.faces.reshaped()[i])]);
}

TEST(JoinedAtSeams, LeavesAMeshWithoutSeams) {
  const TriangleMesh closed = shapes::icosphere(2);
  TriangleMesh open = closed;
  open.faces.conservativeResize(3, open.faces.cols() / 2);
  for (const TriangleMesh& mesh : {closed, open}) {
    const JoinedMesh joined = joined_at_seams(mesh);
    EXPECT_EQ(joined.joined(), 0u);
    EXPECT_EQ(joined.mesh.faces, mesh.faces);
  }
}

TEST(LeftOpen, JoinsNothing) {
  const TriangleMesh cut = shapes::soup(shapes::icosphere(1));
  const JoinedMesh same = left_open(cut);
  EXPECT_EQ(same.joined(), 0u);
  EXPECT_EQ(same.mesh.faces, cut.faces);
  EXPECT_EQ(same.mesh.vertices(Eigen::all, same.of_vertex), cut.vertices);
}

// Two spheres that touch in a vertex, and two triangles that do: no edge in common.
TEST(JoinedAtSeams, LeavesApartWhatTouches) {
  TriangleMesh both;
  both.vertices.resize(3, 6);
  both.vertices << 0, 1, 0, 0, -1, 0,  //
      0, 0, 1, 0, 0, -1,               //
      0, 0, 0, 0, 0, 0;
  both.faces.resize(3, 2);
  both.faces << 0, 3, 1, 4, 2, 5;
  EXPECT_EQ(joined_at_seams(both).joined(), 0u);
  const TriangleMesh ball = shapes::icosphere(1);  // closed surfaces at the same places
  EXPECT_EQ(joined_at_seams(shapes::joined(ball, ball)).joined(), 0u);
}

}  // namespace
}  // namespace bespoke
