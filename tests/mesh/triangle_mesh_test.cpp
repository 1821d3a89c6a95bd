#include "bespoke/mesh/triangle_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TriangleMesh two_triangles(const Faces& faces) {
  TriangleMesh mesh;
  mesh.vertices = Points{{0, 1, 0, 1, 5}, {0, 0, 1, 1, 5}, {0, 0, 0, 0, 5}};
  mesh.faces = faces;
  return mesh;
}

std::string complaint(const TriangleMesh& mesh) {
  return test::error_message<InvalidInput>([&] { require_valid(mesh, "source a.obj"); });
}

TEST(InspectMesh, OfAClosedSurfaceObeysEuler) {
  const MeshFindings findings = inspect_mesh(shapes::icosphere(2));
  EXPECT_EQ(findings.faces, 320u);
  EXPECT_EQ(findings.vertices, 2 + findings.faces / 2);
  EXPECT_EQ(findings.components, 1u);
  EXPECT_EQ(findings.boundary_edges, 0u);
  EXPECT_EQ(findings.non_manifold_edges, 0u);
  EXPECT_EQ(findings.inconsistent_edges, 0u);
  EXPECT_EQ(findings.degenerate_faces, 0u);
  EXPECT_EQ(findings.unreferenced_vertices, 0u);
  EXPECT_EQ(findings.duplicate_vertices, 0u);
  EXPECT_EQ(to_string(findings), "162 vertices, 320 faces, 1 component, closed");
}

TEST(InspectMesh, CountsTheRimOfAnOpenSurface) {
  EXPECT_EQ(inspect_mesh(shapes::square_grid(4)).boundary_edges, 16u);
  EXPECT_EQ(to_string(inspect_mesh(shapes::triangle())), "3 vertices, 1 face, 1 component, 3 boundary edges");
}

TEST(InspectMesh, CountsComponentsAndVerticesInNoFace) {
  TriangleMesh mesh =
      shapes::joined(shapes::cube(), shapes::moved(shapes::cube(), {Matrix3::Identity(), {5, 0, 0}}));
  mesh.vertices.conservativeResize(3, 17);
  mesh.vertices.col(16).setConstant(9);
  const MeshFindings findings = inspect_mesh(mesh);
  EXPECT_EQ(findings.components, 2u);
  EXPECT_EQ(findings.unreferenced_vertices, 1u);
}

TEST(InspectMesh, SeesNeighboursThatFaceOppositeWays) {
  EXPECT_EQ(inspect_mesh(two_triangles(Faces{{0, 1}, {1, 3}, {2, 2}})).inconsistent_edges, 0u);
  EXPECT_EQ(inspect_mesh(two_triangles(Faces{{0, 1}, {1, 2}, {2, 3}})).inconsistent_edges, 1u);
}

TEST(InspectMesh, SeesEdgesOfThreeFaces) {
  const MeshFindings findings = inspect_mesh(two_triangles(Faces{{0, 0, 0}, {1, 1, 1}, {2, 3, 4}}));
  EXPECT_EQ(findings.non_manifold_edges, 1u);
  EXPECT_EQ(findings.boundary_edges, 6u);
}

TEST(InspectMesh, SeesFacesWithoutAreaAndDuplicateVertices) {
  TriangleMesh mesh = two_triangles(Faces{{0, 1, 0}, {1, 1, 1}, {2, 2, 3}});
  mesh.vertices.col(3) = mesh.vertices.col(1);
  const MeshFindings findings = inspect_mesh(mesh);
  EXPECT_EQ(findings.degenerate_faces, 2u);
  EXPECT_EQ(findings.duplicate_vertices, 1u);
  EXPECT_THAT(to_string(findings), HasSubstr("2 faces without area"));
}

TEST(InspectMesh, DescribesBrokenMeshesToo) {
  EXPECT_EQ(to_string(inspect_mesh({})), "0 vertices, 0 faces, 0 components");
  TriangleMesh mesh = shapes::triangle();
  mesh.vertices(0, 0) = nan;
  EXPECT_EQ(inspect_mesh(mesh).degenerate_faces, 1u);
  mesh.faces(0, 0) = 3;
  EXPECT_THROW(inspect_mesh(mesh), InvalidInput);
}

TEST(RequireValidMesh, AcceptsWhatCanBeUsed) {
  EXPECT_EQ(complaint(shapes::triangle()), "accepted");
  EXPECT_EQ(complaint(shapes::cube()), "accepted");
}

TEST(RequireValidMesh, NamesWhatIsWrong) {
  EXPECT_THAT(complaint({}), HasSubstr("source a.obj has no faces"));
  TriangleMesh mesh = shapes::cube();
  mesh.vertices(1, 6) = nan;
  EXPECT_THAT(complaint(mesh), HasSubstr("source a.obj: vertex 6"));
  mesh.vertices(1, 6) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(complaint(mesh), HasSubstr("vertex 6"));
  mesh = shapes::cube();
  mesh.faces(2, 11) = 8;
  EXPECT_THAT(complaint(mesh), HasSubstr("face 11 names vertex 8 of 8"));
  mesh.faces(2, 11) = -1;
  EXPECT_THAT(complaint(mesh), HasSubstr("face 11 names vertex -1 of 8"));
  EXPECT_THAT(complaint(shapes::cube(0)), HasSubstr("one point"));
  EXPECT_THAT(complaint(shapes::cube(1e200)), HasSubstr("too large"));
}

TEST(BoundingBox, EnclosesAllColumnsTightly) {
  EXPECT_EQ(bounding_box(shapes::cube(2).vertices).min(), Vector3(0, 0, 0));
  EXPECT_EQ(bounding_box(shapes::cube(2).vertices).max(), Vector3(2, 2, 2));
  EXPECT_DOUBLE_EQ(diagonal(shapes::cube(2).vertices), std::sqrt(12));
  EXPECT_TRUE(bounding_box(Points(3, 0)).isEmpty());
  EXPECT_EQ(diagonal(Points(3, 0)), 0);
}

TEST(FaceNormals, AreUnitAndPointOutward) {
  const TriangleMesh sphere = shapes::icosphere(1);
  const Points normals = face_normals(sphere);
  for (Eigen::Index face = 0; face < sphere.faces.cols(); ++face) {
    const Vector3 corner = sphere.vertices.col(sphere.faces(0, face));
    EXPECT_NEAR(normals.col(face).norm(), 1, 1e-15);
    EXPECT_GT(normals.col(face).dot(corner), 0.5);
  }
}

TEST(FaceNormals, DoNotDependOnTheScale) {
  for (const double scale : {1e-60, 1e60})
    EXPECT_EQ(face_normals(shapes::moved(shapes::triangle(), {scale * Matrix3::Identity(), {0, 0, 0}})),
              Points(Vector3(0, 0, 1)));
}

TEST(FaceNormals, AreZeroWithoutArea) {
  TriangleMesh line;
  line.vertices = Points{{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {0.7, 1.4, 2.1}};
  line.faces = Faces{{0, 0}, {1, 1}, {2, 1}};
  EXPECT_EQ(face_normals(line), Points::Zero(3, 2));
}

TEST(VertexNormals, DoNotDependOnHowAnAngleIsDivided) {
  // Every corner of a cube belongs to three right angles, however their squares are cut.
  const TriangleMesh cube = shapes::cube();
  const Points normals = vertex_normals(cube);
  const Points expected = (cube.vertices.array() * 2 - 1).matrix() / std::sqrt(3.0);
  EXPECT_LT((normals - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(VertexNormals, AreZeroWhereUndefined) {
  EXPECT_EQ(vertex_normals(two_triangles(Faces{{0}, {1}, {2}})).col(4), Vector3::Zero());
  EXPECT_EQ(vertex_normals(two_triangles(Faces{{0, 0}, {1, 2}, {2, 1}})), Points::Zero(3, 5));
}

TEST(VertexAreas, ShareTheFacesInThirds) {
  const Eigen::VectorXd areas = vertex_areas(two_triangles(Faces{{2, 1}, {0, 3}, {1, 2}}));
  EXPECT_TRUE(areas.isApprox((Eigen::VectorXd(5) << 1, 2, 2, 1, 0).finished() / 6, 1e-15));
  EXPECT_NEAR(vertex_areas(shapes::cube()).sum(), 6, 1e-14);
}

TEST(ContentHash, DependsOnContentAlone) {
  const TriangleMesh mesh = shapes::cube();
  TriangleMesh other = mesh;
  EXPECT_EQ(content_hash(mesh), content_hash(other));
  EXPECT_EQ(content_hash(mesh).size(), 64u);
  other.vertices(0, 0) = std::numeric_limits<double>::denorm_min();  // none of it is left in a float
  EXPECT_EQ(content_hash(mesh), content_hash(other));
  other.vertices(0, 0) = static_cast<double>(std::numeric_limits<float>::denorm_min());
  EXPECT_NE(content_hash(mesh), content_hash(other));
  other = mesh;
  other.faces(0, 0) = 1;
  EXPECT_NE(content_hash(mesh), content_hash(other));
}

}  // namespace
}  // namespace bespoke
