#include "bespoke/topology/edge_refinement.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

double longest_edge(const TriangleMesh& mesh) {
  double longest = 0;
  for (const auto& face : mesh.faces.colwise())
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (mesh.vertices.col(face[k]) - mesh.vertices.col(face[(k + 1) % 3])).norm());
  return longest;
}

/// A third of the sum over the faces of corner a · (b × c): the enclosed volume times 2.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& face : mesh.faces.colwise()) {
    const Vector3 a = mesh.vertices.col(face[0]), b = mesh.vertices.col(face[1]),
                  c = mesh.vertices.col(face[2]);
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

TEST(RefineLongEdges, ShortensEveryEdgeAndKeepsTheSurfaceClosed) {
  const RefinedMesh refined = refine_long_edges(shapes::cube(1), 0.3);
  EXPECT_LE(longest_edge(refined.mesh), 0.3);
  const MeshFindings findings = inspect_mesh(refined.mesh);
  EXPECT_EQ(findings.boundary_edges, 0u);
  EXPECT_EQ(findings.non_manifold_edges, 0u);
  EXPECT_EQ(findings.inconsistent_edges, 0u);
  EXPECT_EQ(findings.degenerate_faces, 0u);
  EXPECT_NEAR(volume(refined.mesh), 1, 1e-12);
}

TEST(RefineLongEdges, KeepsVerticesAndNamesTheParentsOfNewOnes) {
  const TriangleMesh cube = shapes::cube(2);
  const RefinedMesh refined = refine_long_edges(cube, 0.5);
  EXPECT_EQ(refined.mesh.vertices.leftCols(8), cube.vertices);
  ASSERT_EQ(refined.parents.cols(), refined.mesh.vertices.cols() - 8);
  for (Eigen::Index k = 0; k < refined.parents.cols(); ++k) {
    const Vector3 middle = (refined.mesh.vertices.col(refined.parents(0, k)) +
                            refined.mesh.vertices.col(refined.parents(1, k))) /
                           2;
    EXPECT_EQ(middle, Vector3(refined.mesh.vertices.col(8 + k)));
  }
}

TEST(RefineLongEdges, NamesTheFaceThatEachPartIsOf) {
  const TriangleMesh cube = shapes::cube(1);
  const RefinedMesh refined = refine_long_edges(cube, 0.3);
  ASSERT_EQ(refined.origins.size(), static_cast<std::size_t>(refined.mesh.faces.cols()));
  const auto twice_area = [](const TriangleMesh& mesh, Eigen::Index face) {
    const Vector3 a = mesh.vertices.col(mesh.faces(0, face));
    return (mesh.vertices.col(mesh.faces(1, face)) - a).cross(mesh.vertices.col(mesh.faces(2, face)) - a);
  };
  Points sums = Points::Zero(3, 12);
  for (Eigen::Index face = 0; face < refined.mesh.faces.cols(); ++face) {
    const int origin = refined.origins[static_cast<std::size_t>(face)];
    const Vector3 corner = cube.vertices.col(cube.faces(0, origin)), normal = twice_area(cube, origin);
    for (const int vertex : refined.mesh.faces.col(face))
      EXPECT_NEAR(normal.dot(refined.mesh.vertices.col(vertex) - corner), 0, 1e-12);
    sums.col(origin) += twice_area(refined.mesh, face);
  }
  for (Eigen::Index face = 0; face < 12; ++face)
    EXPECT_TRUE(sums.col(face).isApprox(twice_area(cube, face), 1e-12));
}

TEST(RefineLongEdges, HalvesOneTwoOrThreeEdgesOfAFace) {
  TriangleMesh one = shapes::triangle();
  one.vertices.col(1) = Vector3(1, 0, 0);
  one.vertices.col(2) = Vector3(0.4, 0.2, 0);
  EXPECT_EQ(refine_long_edges(one, 0.9, 1).mesh.faces.cols(), 2);
  EXPECT_EQ(refine_long_edges(one, 0.5, 1).mesh.faces.cols(), 3);
  EXPECT_EQ(refine_long_edges(one, 0.4, 1).mesh.faces.cols(), 4);
}

TEST(RefineLongEdges, LeavesShortEdgesAlone) {
  const TriangleMesh sphere = shapes::icosphere(1);
  const RefinedMesh refined = refine_long_edges(sphere, 3);
  EXPECT_EQ(refined.mesh.vertices, sphere.vertices);
  EXPECT_EQ(refined.mesh.faces, sphere.faces);
}

TEST(RefineLongEdges, RejectsALengthThatIsNone) {
  EXPECT_THROW(refine_long_edges(shapes::triangle(), 0), InvalidInput);
  EXPECT_THROW(refine_long_edges(shapes::triangle(), std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace bespoke
