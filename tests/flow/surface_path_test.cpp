#include "bespoke/flow/surface_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "flow/bent_tube.h"
#include "support/arithmetic.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::degree;

std::vector<int> columns_between(const Points& x, double low, double high) {
  std::vector<int> columns;
  for (int i = 0; i < static_cast<int>(x.cols()); ++i)
    if (x(0, i) >= low && x(0, i) <= high) columns.push_back(i);
  return columns;
}

/// Largest distance of the columns from a rigid motion of themselves.
double deviation_from_rigid(const Points& before, const Points& after, const std::vector<int>& columns) {
  const Points a = before(Eigen::all, columns), b = after(Eigen::all, columns);
  return (align_rigidly(a, b, Eigen::VectorXd::Ones(a.cols())) * a - b).colwise().norm().maxCoeff();
}

Matrix3 rotation_between(const Points& before, const Points& after, const std::vector<int>& columns) {
  const Points a = before(Eigen::all, columns), b = after(Eigen::all, columns);
  return align_rigidly(a, b, Eigen::VectorXd::Ones(a.cols())).rotation;
}

class LimbTurned : public ::testing::TestWithParam<double> {};

TEST_P(LimbTurned, StaysRigidWhileItBends) {
  const TriangleMesh source = test::tube();
  const Points fitted = test::bent(source.vertices, GetParam() * degree);
  const SurfacePath path(source, fitted);
  const std::vector<int> limb = columns_between(source.vertices, 7, 10);
  const std::vector<int> trunk = columns_between(source.vertices, 0, 3);
  for (const double t : {0.2, 0.5, 0.8}) {
    const Points between = path.at(t);
    // 1 % of the limb's length; a straight displacement misses by most of its length.
    EXPECT_LT(deviation_from_rigid(source.vertices, between, limb), 0.03) << t;
    EXPECT_LT(deviation_from_rigid(source.vertices, between, trunk), 0.03) << t;
    const Matrix3 turn = rotation_between(source.vertices, between, limb) *
                         rotation_between(source.vertices, between, trunk).transpose();
    const Matrix3 expected = Eigen::AngleAxisd(t * GetParam() * degree, Vector3::UnitZ()).toRotationMatrix();
    EXPECT_LT(Eigen::AngleAxisd(Matrix3(expected.transpose() * turn)).angle(), 1 * degree) << t;
  }
}

TEST_P(LimbTurned, StaysRigidWhileItTwists) {
  const TriangleMesh source = test::tube(81);
  const Points fitted = test::twisted(source.vertices, GetParam() * degree);
  const SurfacePath path(source, fitted);
  const std::vector<int> limb = columns_between(source.vertices, 7, 10);
  const Points between = path.at(0.5);
  EXPECT_LT(deviation_from_rigid(source.vertices, between, limb), 0.03);
  const Matrix3 expected = Eigen::AngleAxisd(0.5 * GetParam() * degree, Vector3::UnitX()).toRotationMatrix();
  const Matrix3 turn =
      rotation_between(source.vertices, between, limb) *
      rotation_between(source.vertices, between, columns_between(source.vertices, 0, 3)).transpose();
  EXPECT_LT(Eigen::AngleAxisd(Matrix3(expected.transpose() * turn)).angle(), 1 * degree);
}

TEST_P(LimbTurned, IsMeasuredAlongThePath) {
  const TriangleMesh source = test::tube();
  const Points fitted = test::bent(source.vertices, GetParam() * degree);
  EXPECT_NEAR(SurfacePath(source, fitted).motion().turn, GetParam() * degree, 1 * degree);
}

INSTANTIATE_TEST_SUITE_P(Degrees, LimbTurned, ::testing::Values(90.0, 170.0, 270.0));

TEST(SurfacePath, EndsExactly) {
  const TriangleMesh source = shapes::joined(shapes::icosphere(2), shapes::triangle());
  const Points fitted = source.vertices + 0.3 * test::random_points(source.vertices.cols(), 5);
  const SurfacePath path(source, fitted);
  EXPECT_EQ(path.at(0), source.vertices);
  EXPECT_EQ(path.at(1), fitted);
  // And goes there: no jump at either end.
  EXPECT_LT((path.at(1e-9) - source.vertices).norm(), 1e-6);
  EXPECT_LT((path.at(1 - 1e-9) - fitted).norm(), 1e-6);
}

TEST(SurfacePath, OfTheIdentityStaysWhereItIs) {
  const TriangleMesh source = shapes::joined(shapes::icosphere(2), shapes::cube(0.4));
  const SurfacePath path(source, source.vertices);
  for (const double t : {0.25, 0.5, 1.0})
    EXPECT_LT((path.at(t) - source.vertices).colwise().norm().maxCoeff(), 1e-12) << t;
  EXPECT_LT(path.motion().turn, 1e-7);
  EXPECT_NEAR(path.motion().stretch, 1, 1e-12);
}

TEST(SurfacePath, OfAStretchIsThatStretchInPart) {
  const TriangleMesh source = shapes::icosphere(3);
  const Matrix3 stretch = Vector3(1, 2, 0.5).asDiagonal();
  const Points quarter = SurfacePath(source, stretch * source.vertices).at(0.25);
  const Matrix3 expected = Vector3(1, 1.25, 0.875).asDiagonal();
  // The normals' part of a face's gradient is that of its area, so that a stretched face turns a little.
  EXPECT_LT((quarter - expected * source.vertices).colwise().norm().maxCoeff(), 0.05);
}

TEST(SurfacePath, CarriesPiecesWithTheSurfaceAroundThem) {
  // A ball in the tube's limb, linked to nothing.
  const TriangleMesh tube = test::tube();
  TriangleMesh ball = shapes::icosphere(1);
  ball.vertices = (0.2 * ball.vertices).colwise() + Vector3(8, 0, 0);
  const TriangleMesh source = shapes::joined(tube, ball);
  const SurfacePath path(source, test::bent(source.vertices, 170 * degree));
  std::vector<int> limb = columns_between(source.vertices, 7, 10);
  for (const double t : {0.3, 0.6})
    EXPECT_LT(deviation_from_rigid(source.vertices, path.at(t), limb), 0.03) << t;
}

TEST(SurfacePath, CarriesAVertexOfNoFace) {
  TriangleMesh source = test::tube();
  const Eigen::Index loose = source.vertices.cols();
  source.vertices.conservativeResize(3, loose + 1);
  source.vertices.col(loose) << 9, 0, 0.7;
  const Points fitted = test::bent(source.vertices, 90 * degree);
  const Points between = SurfacePath(source, fitted).at(0.5);
  std::vector<int> limb = columns_between(source.vertices, 7, 10);
  EXPECT_LT(deviation_from_rigid(source.vertices, between, limb), 0.03);
}

TEST(SurfacePath, KeepsSeamsClosed) {
  // Two triangles that share an edge's places but not its vertices.
  TriangleMesh source = shapes::joined(shapes::triangle(), shapes::triangle());
  source.vertices.col(3) << 1, 0, 0;
  source.vertices.col(4) << 1, 1, 0;
  source.vertices.col(5) << 0, 1, 0;
  Points fitted = source.vertices;
  fitted.col(4) << 0.5, 0.5, 0.7;
  const Points between = SurfacePath(source, fitted).at(0.5);
  EXPECT_LT((between.col(1) - between.col(3)).norm(), 1e-12);
  EXPECT_LT((between.col(2) - between.col(5)).norm(), 1e-12);
}

TEST(SurfacePath, TakesFacesWithoutArea) {
  TriangleMesh source = shapes::square_grid(4);
  source.faces.conservativeResize(3, source.faces.cols() + 1);
  source.faces.rightCols<1>() << 0, 1, 2;  // along one side
  Points fitted = source.vertices;
  fitted.row(2) = fitted.row(0).array().square();
  fitted.col(1) = fitted.col(0);  // and one that the fit has closed
  const SurfacePath path(source, fitted);
  EXPECT_TRUE(path.at(0.5).allFinite());
  EXPECT_EQ(path.at(1), fitted);
}

TEST(SurfacePath, RejectsWhatIsNoPath) {
  const TriangleMesh source = shapes::cube();
  EXPECT_THROW(SurfacePath(source, source.vertices.leftCols(5)), InvalidInput);
  Points not_finite = source.vertices;
  not_finite(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SurfacePath(source, not_finite), InvalidInput);
  EXPECT_THROW(SurfacePath(source, source.vertices).at(1.5), InvalidInput);
  EXPECT_THROW(SurfacePath(source, source.vertices).at(std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace bespoke
