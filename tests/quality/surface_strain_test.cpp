#include "bespoke/quality/surface_strain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bespoke/error.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const Vector3 away{5, 0, 0};

/// Two unit squares in the plane z = 0, the second one `away`.
TriangleMesh two_squares(int n) {
  const TriangleMesh square = shapes::square_grid(n);
  return shapes::joined(square, shapes::moved(square, {Matrix3::Identity(), away}));
}

/// The second square of two, mapped about its corner.
Points second_mapped(const TriangleMesh& squares, const Matrix3& linear) {
  Points after = squares.vertices;
  const Eigen::Index half = after.cols() / 2;
  after.rightCols(half) = (linear * (after.rightCols(half).colwise() - away)).colwise() + away;
  return after;
}

std::vector<SurfacePoint> places_on(const TriangleMesh& mesh, const Points& points) {
  const ClosestPointTree tree(mesh);
  std::vector<SurfacePoint> places;
  for (const auto& point : points.colwise()) places.push_back(*tree.closest(point));
  return places;
}

/// The middles of two squares.
std::vector<SurfacePoint> middles(const TriangleMesh& squares) {
  Points points(3, 2);
  points << Vector3(0.5, 0.5, 0), away + Vector3(0.5, 0.5, 0);
  return places_on(squares, points);
}

TEST(SurfaceStrain, IsNoneUnderASimilarity) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const Points after = (2.5 * test::random_rotation(4) * sphere.vertices).colwise() + Vector3(1, 2, 3);
  EXPECT_LT(strain_around(sphere, after, places_on(sphere, sphere.vertices.leftCols(5)), 0.3).maxCoeff(),
            1e-7);
}

TEST(SurfaceStrain, IsThatOfTheFacesAroundAPlace) {
  const TriangleMesh squares = two_squares(10);
  const Matrix3 same_area = Vector3(2, 0.5, 1).asDiagonal();
  const Eigen::VectorXd strain =
      strain_around(squares, second_mapped(squares, same_area), middles(squares), 0.2);
  EXPECT_LT(strain[0], 1e-7);
  EXPECT_NEAR(strain[1], std::numbers::sqrt2 * std::log(2), 1e-12);
}

TEST(SurfaceStrain, IsBesideTheScaleOfTheWholeSurface) {
  const TriangleMesh squares = two_squares(10);
  const Eigen::VectorXd strain =
      strain_around(squares, second_mapped(squares, 3 * Matrix3::Identity()), middles(squares), 0.2);
  const double scale = std::sqrt((1.0 + 9.0) / 2);
  EXPECT_NEAR(strain[0], std::numbers::sqrt2 * std::log(scale), 1e-12);
  EXPECT_NEAR(strain[1], std::numbers::sqrt2 * std::log(3 / scale), 1e-12);
}

TEST(SurfaceStrain, IsTheSameHoweverTheMeshLiesInSpaceAndWhateverItsUnit) {
  const TriangleMesh squares = two_squares(10);
  const Matrix3 sheared = (Matrix3() << 1, 0.7, 0, 0, 1, 0, 0, 0, 1).finished();
  const Points after = second_mapped(squares, sheared);
  const Matrix3 turned = test::random_rotation(2);
  const Eigen::VectorXd here = strain_around(squares, after, middles(squares), 0.2);
  const TriangleMesh larger{1000 * turned * squares.vertices, squares.faces};
  const Points corners =
      1000 * turned * (Points(3, 2) << Vector3(0.5, 0.5, 0), away + Vector3(0.5, 0.5, 0)).finished();
  const Eigen::VectorXd there =
      strain_around(larger, turned * turned * after, places_on(larger, corners), 200);
  // Principal stretches of a shear by 0.7: their product is 1.
  const double stretch = 0.35 + std::hypot(1, 0.35);
  EXPECT_NEAR(here[1], std::numbers::sqrt2 * std::log(stretch), 1e-9);
  EXPECT_LT((here - there).cwiseAbs().maxCoeff(), 1e-7);  // the root of rounding where there is no strain
}

TEST(SurfaceStrain, OfACollapseIsThatOfATenth) {
  const TriangleMesh squares = two_squares(4);
  const Eigen::VectorXd strain =
      strain_around(squares, second_mapped(squares, Matrix3::Zero()), middles(squares), 0.4);
  EXPECT_NEAR(strain[1], std::numbers::sqrt2 * std::log(10), 1e-12);
  EXPECT_NEAR(strain[0], std::numbers::sqrt2 * std::log(2) / 2, 1e-12);
}

TEST(SurfaceStrain, IsThatOfTheNearestFaceWhereNoCentreIsWithinReach) {
  const TriangleMesh squares = two_squares(1);
  const Matrix3 same_area = Vector3(2, 0.5, 1).asDiagonal();
  EXPECT_NEAR(strain_around(squares, second_mapped(squares, same_area), middles(squares), 1e-3)[1],
              std::numbers::sqrt2 * std::log(2), 1e-12);
}

TEST(SurfaceStrain, TakesNoNoticeOfFacesWithoutArea) {
  TriangleMesh squares = two_squares(4);
  const Eigen::Index before = squares.faces.cols();
  squares.faces.conservativeResize(3, before + 2);
  squares.faces.col(before) << 30, 30, 31;      // two equal corners
  squares.faces.col(before + 1) << 25, 26, 27;  // on a line
  const Matrix3 same_area = Vector3(2, 0.5, 1).asDiagonal();
  EXPECT_NEAR(strain_around(squares, second_mapped(squares, same_area), middles(squares), 0.4)[1],
              std::numbers::sqrt2 * std::log(2), 1e-12);
}

TEST(SurfaceStrain, RefusesWhatCannotBeMeasured) {
  const TriangleMesh square = shapes::square_grid(2);
  const std::vector<SurfacePoint> place = places_on(square, Points::Zero(3, 1));
  const Points after = square.vertices;
  Points broken = after;
  broken(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(strain_around(square, after.leftCols(3), place, 1), InvalidInput);
  EXPECT_THROW(strain_around(square, broken, place, 1), InvalidInput);
  EXPECT_THROW(strain_around({broken, square.faces}, after, place, 1), InvalidInput);
  EXPECT_THROW(strain_around(square, after, place, 0), InvalidInput);
  EXPECT_THROW(strain_around(square, after, place, std::nan("")), InvalidInput);
  EXPECT_THROW(strain_around(square, Points::Zero(3, after.cols()), place, 1), InvalidInput);
  EXPECT_THROW(strain_around({after, Faces(3, 0)}, after, place, 1), InvalidInput);
}

}  // namespace
}  // namespace bespoke
