#include "bespoke/flow/detail/face_gradients.h"

#include <gtest/gtest.h>

#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(FaceGradients, OfARotationAreThatRotation) {
  const TriangleMesh source = shapes::icosphere(1);
  const Matrix3 rotation = test::random_rotation(3);
  const FaceGradients gradients = face_gradients(source, rotation * source.vertices);
  for (Eigen::Index face = 0; face < gradients.faces(); ++face)
    EXPECT_LT((gradients.of(face) - rotation).norm(), 1e-12);
}

TEST(FaceGradients, TakeEdgesToFittedEdges) {
  const TriangleMesh source = shapes::icosphere(1);
  const Points fitted = test::random_points(source.vertices.cols(), 4);
  const FaceGradients gradients = face_gradients(source, fitted);
  for (Eigen::Index face = 0; face < gradients.faces(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int a = source.faces(k, face), b = source.faces((k + 1) % 3, face);
      const Vector3 edge = gradients.of(face) * (source.vertices.col(b) - source.vertices.col(a));
      EXPECT_LT((edge - (fitted.col(b) - fitted.col(a))).norm(), 1e-11);
    }
}

TEST(FaceGradients, KnowTheAreas) {
  TriangleMesh source = shapes::cube(2);
  const FaceGradients gradients = face_gradients(source, source.vertices);
  for (Eigen::Index face = 0; face < gradients.faces(); ++face) EXPECT_NEAR(gradients.areas[face], 2, 1e-12);
}

TEST(FaceGradients, AreNoneWithoutArea) {
  TriangleMesh source = shapes::square_grid(2);
  source.faces.col(0) << 0, 1, 2;
  const FaceGradients gradients = face_gradients(source, 3 * source.vertices);
  EXPECT_EQ(gradients.areas[0], 0);
  EXPECT_EQ(gradients.of(0), Matrix3::Identity());
}

}  // namespace
}  // namespace bespoke
