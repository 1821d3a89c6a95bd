#include "bespoke/flow/detail/face_rotations.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "flow/bent_tube.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double pi = std::numbers::pi;

std::vector<int> all_faces(const TriangleMesh& mesh) {
  std::vector<int> faces(static_cast<std::size_t>(mesh.faces.cols()));
  std::iota(faces.begin(), faces.end(), 0);
  return faces;
}

TEST(RotationVectorNear, IsTheBranchNextToItsNeighbour) {
  const Vector3 axis = Vector3(1, 2, -1).normalized();
  for (const double angle : {-5.0, -3.0, 0.4, 3.0, 3.5, 6.0, 9.0}) {
    const Vector3 vector = angle * axis;
    const Vector3 nearby = vector + Vector3(0.1, -0.2, 0.1);
    EXPECT_LT((rotation_vector_near(rotation_of(vector), nearby) - vector).norm(), 1e-12) << angle;
  }
}

TEST(RotationVectorNear, TakesItsAxisFromTheNeighbourAtAFullTurn) {
  const Vector3 nearby(0, 6.1, 0);
  EXPECT_LT((rotation_vector_near(Matrix3::Identity(), nearby) - Vector3(0, 2 * pi, 0)).norm(), 1e-12);
  EXPECT_EQ(rotation_vector_near(Matrix3::Identity(), Vector3::Zero()), Vector3::Zero());
}

TEST(FaceNeighbours, ShareAnEdge) {
  const FaceNeighbours neighbours = face_neighbours(shapes::icosphere(1));
  for (std::size_t face = 0; face + 1 < neighbours.start.size(); ++face)
    EXPECT_EQ(neighbours.start[face + 1] - neighbours.start[face], 3);
  EXPECT_TRUE(face_neighbours(shapes::triangle()).faces.empty());
}

TEST(FaceRotations, GoFromTheIdentityToTheGradient) {
  const TriangleMesh source = shapes::icosphere(2);
  const Points fitted = source.vertices + 0.5 * test::random_points(source.vertices.cols(), 8);
  const FaceGradients gradients = face_gradients(source, fitted);
  FaceRotations rotations(source, gradients);
  rotations.spread(all_faces(source), Vector3::Zero());
  for (Eigen::Index face = 0; face < gradients.faces(); ++face) {
    EXPECT_LT((rotations.at(face, 0) - Matrix3::Identity()).norm(), 1e-12);
    EXPECT_LT((rotations.at(face, 1) - gradients.of(face)).norm(), 1e-11 * (1 + gradients.of(face).norm()));
  }
}

TEST(FaceRotations, ExceedHalfATurnWhereNeighboursDo) {
  const TriangleMesh source = test::tube();
  const FaceGradients gradients = face_gradients(source, test::bent(source.vertices, 1.5 * pi));
  FaceRotations rotations(source, gradients);
  rotations.spread(all_faces(source), Vector3::Zero());
  EXPECT_LT((rotations.vector(0) - Vector3::Zero()).norm(), 1e-9);
  EXPECT_LT((rotations.vector(gradients.faces() - 1) - Vector3(0, 0, 1.5 * pi)).norm(), 1e-9);
}

TEST(FaceRotations, StartFromTheReferencesBranch) {
  const TriangleMesh source = shapes::icosphere(1);
  const Vector3 vector = 1.5 * pi * Vector3::UnitY();
  const FaceGradients gradients = face_gradients(source, rotation_of(vector) * source.vertices);
  FaceRotations rotations(source, gradients);
  rotations.spread(all_faces(source), vector * 0.9);
  for (Eigen::Index face = 0; face < gradients.faces(); ++face)
    EXPECT_LT((rotations.vector(face) - vector).norm(), 1e-9);
}

TEST(FaceRotations, OfAFoldedFaceAreItsNeighbours) {
  // The middle of a strip is flipped.
  const TriangleMesh source = shapes::square_grid(6);
  Points fitted = source.vertices;
  const int vertex = 3 * 7 + 3;
  fitted.col(vertex) += Vector3(0.4, 0, 0);
  const FaceGradients gradients = face_gradients(source, fitted);
  FaceRotations rotations(source, gradients);
  rotations.spread(all_faces(source), Vector3::Zero());
  for (Eigen::Index face = 0; face < gradients.faces(); ++face)
    EXPECT_LT(rotations.vector(face).norm(), 2.0 / 3 * pi) << face;
}

}  // namespace
}  // namespace bespoke
