#include "bespoke/elastic/pffd_smooth.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "bespoke/error.h"
#include "support/finite_differences.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double lambda = 0.5;

/// A smooth change of the unit sphere that is not affine.
Points parabolic(const Points& x) {
  Points result = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    result(0, i) += 0.2 * x(1, i) * x(1, i);
    result(2, i) *= 1.3;
  }
  return result;
}

Matrix3 corners(const Points& points, const Faces& faces, Eigen::Index face) {
  Matrix3 result;
  for (int corner = 0; corner < 3; ++corner) result.col(corner) = points.col(faces(corner, face));
  return result;
}

struct Scene {
  TriangleMesh source = shapes::icosphere(2);
  Points fitted = parabolic(source.vertices);
  SmoothPffdMap map = SmoothPffdMap(source, fitted, lambda);
};

Points points_in_shell(int count, double low, double high) {
  std::mt19937 generator(5);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> radius(low, high);
  Points result(3, count);
  for (int i = 0; i < count; ++i)
    result.col(i) =
        radius(generator) * Vector3(normal(generator), normal(generator), normal(generator)).normalized();
  return result;
}

TEST(SmoothPffdMap, CarriesTheSourceSurfaceOntoTheFittedOne) {
  const Scene scene;
  EXPECT_LT((scene.map(scene.source.vertices) - scene.fitted).cwiseAbs().maxCoeff(), 1e-12);
  const Vector3 barycentric(0.2, 0.5, 0.3);
  for (Eigen::Index face = 0; face < scene.source.faces.cols(); ++face) {
    const Vector3 from = corners(scene.source.vertices, scene.source.faces, face) * barycentric;
    const Vector3 to = corners(scene.fitted, scene.source.faces, face) * barycentric;
    EXPECT_LT((scene.map(from).col(0) - to).norm(), 1e-12);
  }
}

TEST(SmoothPffdMap, JoinsTheSurfaceContinuously) {
  const Scene scene;
  for (const double height : {1e-3, 1e-5, 1e-8, 1e-12}) {
    const Points near = (1 + height) * scene.source.vertices;
    EXPECT_LT((scene.map(near) - scene.fitted).colwise().norm().maxCoeff(), 5 * height + 1e-12);
  }
}

TEST(SmoothPffdMap, ReproducesSimilaritiesEverywhere) {
  const TriangleMesh source = shapes::icosphere(2);
  const AffineMap similarity{1.7 * Eigen::AngleAxisd(0.6, Vector3(1, 2, 3).normalized()).toRotationMatrix(),
                             Vector3(3, 1, 2)};
  const SmoothPffdMap map(source, similarity * source.vertices, lambda);
  const Points x = points_in_shell(300, 0, 3);
  EXPECT_LT((map(x) - similarity * x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SmoothPffdMap, IsAffineFromLambdaOnAndJoinsItContinuously) {
  const Scene scene;
  const Points beyond = points_in_shell(200, 1 + lambda, 4);
  EXPECT_EQ(scene.map.displacement(beyond).cwiseAbs().maxCoeff(), 0);
  const Points inside = points_in_shell(200, 0, 0.3);  // the inradius of the mesh exceeds 0.9
  EXPECT_EQ(scene.map.displacement(inside).cwiseAbs().maxCoeff(), 0);
  const Points rim = points_in_shell(200, 1 + 0.98 * lambda, 1 + lambda);
  EXPECT_LT(scene.map.displacement(rim).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_GT(scene.map.displacement(points_in_shell(200, 1, 1.1)).cwiseAbs().maxCoeff(), 0.05);
}

TEST(SmoothPffdMap, GradientIsTheLimitOfDifferences) {
  const Scene scene;
  const Points x = points_in_shell(200, 0.5, 1.5);
  const Points slope = test::finite_differences(scene.map, x, 1e-6);
  EXPECT_LT((scene.map.displacement_gradient(x) - slope).colwise().norm().maxCoeff(), 1e-5);
}

TEST(SmoothPffdMap, GradientOnAFaceIsThatOfItsFrame) {
  const Scene scene;
  const Matrix3 from = corners(scene.source.vertices, scene.source.faces, 11);
  const Matrix3 to = corners(scene.fitted, scene.source.faces, 11);
  const Matrix3 jacobian = scene.map.affine().linear + scene.map.displacement_gradient(from.rowwise().mean());
  EXPECT_LT((jacobian * (from.col(1) - from.col(0)) - (to.col(1) - to.col(0))).norm(), 1e-9);
  const Vector3 normal = (from.col(1) - from.col(0)).cross(from.col(2) - from.col(0));
  const Vector3 fitted_normal = (to.col(1) - to.col(0)).cross(to.col(2) - to.col(0));
  const double stretch = std::sqrt(fitted_normal.norm() / normal.norm());
  EXPECT_LT((jacobian * normal.normalized() - stretch * fitted_normal.normalized()).norm(), 1e-6);
}

TEST(SmoothPffdMap, SupportHoldsAllThatMoves) {
  TriangleMesh coarse = shapes::cube();
  const SmoothPffdMap map(coarse, parabolic(coarse.vertices), 0.2);
  const Support support = map.support();
  ASSERT_EQ(support.clouds.size(), 1u);
  const BallCloud& cloud = support.clouds[0];
  const Points x = points_in_shell(3000, 0, 2).colwise() + Vector3::Constant(0.5);
  const Points moved = map.displacement(x);
  int count = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (moved.col(i).isZero(0)) continue;
    ++count;
    EXPECT_LE(
        (cloud.centers.colwise() - Vector3(support.frame * Vector3(x.col(i)))).colwise().norm().minCoeff(),
        cloud.radius);
  }
  EXPECT_GT(count, 100);
}

TEST(SmoothPffdMap, KeepsTheThirdDimensionOfAFlatSource) {
  TriangleMesh flat = shapes::square_grid(3);
  const SmoothPffdMap map(flat, 2 * flat.vertices, 0.2);
  EXPECT_TRUE(map(Vector3(0.4, 0.4, 5)).isApprox(Vector3(0.8, 0.8, 5), 1e-12));
}

TEST(SmoothPffdMap, IgnoresFacesWithoutAreaAndLooseVertices) {
  TriangleMesh source = shapes::icosphere(2);
  const SmoothPffdMap clean(source, parabolic(source.vertices), lambda);
  TriangleMesh dirty = source;
  dirty.faces.conservativeResize(3, dirty.faces.cols() + 1);
  dirty.faces.rightCols(1) << 0, 0, 1;
  dirty.vertices.conservativeResize(3, dirty.vertices.cols() + 1);
  dirty.vertices.rightCols(1) = Vector3(9, 9, 9);
  Points fitted(3, dirty.vertices.cols());
  fitted << parabolic(source.vertices), Vector3(-5, 0, 0);
  const Points x = points_in_shell(100, 0.5, 1.5);
  EXPECT_EQ(SmoothPffdMap(dirty, fitted, lambda)(x), clean(x));
}

TEST(SmoothPffdMap, RejectsWhatItCannotUse) {
  const TriangleMesh triangle = shapes::triangle();
  EXPECT_THROW(SmoothPffdMap(triangle, triangle.vertices.leftCols(2), 1), InvalidInput);
  EXPECT_THROW(SmoothPffdMap(triangle, triangle.vertices, 0), InvalidInput);
  EXPECT_THROW(SmoothPffdMap(triangle, triangle.vertices, std::nan("")), InvalidInput);
  EXPECT_THROW(SmoothPffdMap(triangle, triangle.vertices * std::nan(""), 1), InvalidInput);
  TriangleMesh line = triangle;
  line.vertices.col(2) = Vector3(0.5, 0, 0);
  EXPECT_THROW(SmoothPffdMap(line, line.vertices, 1), InvalidInput);
  EXPECT_NO_THROW(SmoothPffdMap(triangle, triangle.vertices, 1));
}

}  // namespace
}  // namespace bespoke
