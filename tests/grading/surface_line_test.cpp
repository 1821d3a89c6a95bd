#include "bespoke/grading/detail/surface_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/error.h"
#include "bespoke/quality/plane_section.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

Points columns(const std::vector<Vector3>& points) {
  Points matrix(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) matrix.col(static_cast<Eigen::Index>(i)) = points[i];
  return matrix;
}

TEST(SurfaceLine, IsTheShortestWayOverASphere) {
  const ClosestPointTree sphere(shapes::icosphere(5));
  // The chords pass deep below the surface, and the points lie off it.
  const Points quarter = surface_line(sphere, columns({{0, 3, 0}, {1.01, 0, 0}}), {false, 0.01});
  EXPECT_NEAR(line_length(quarter, false), std::numbers::pi / 2, 2e-3);
  EXPECT_LE((quarter.row(2)).cwiseAbs().maxCoeff(), 1e-2);
  const Points round =
      surface_line(sphere, columns({{1, 0, 0}, {-0.6, 0, 0.8}, {-0.6, 0, -0.8}}), {true, 0.01});
  EXPECT_NEAR(line_length(round, true), 2 * std::numbers::pi, 8e-3);
}

TEST(SurfaceLine, LiesOnTheSurfaceInPiecesNoLongerThanTheSpacing) {
  const TriangleMesh cube = shapes::cube(2);
  const ClosestPointTree surface(cube);
  const Points line = surface_line(surface, columns({{0.5, 2, 1}, {2, 0.5, 1}}), {false, 0.03});
  for (Eigen::Index i = 0; i < line.cols(); ++i)
    EXPECT_LE(surface.closest(line.col(i))->squared_distance, 1e-24);
  for (Eigen::Index i = 1; i < line.cols(); ++i) EXPECT_LE((line.col(i) - line.col(i - 1)).norm(), 0.03);
  // Over the edge between, whose corner one piece may cut.
  EXPECT_LE(line_length(line, false), 3 + 1e-9);
  EXPECT_GE(line_length(line, false), 3 - 0.03);
}

TEST(SurfaceLine, RefusesToLeapFromOnePartToAnother) {
  TriangleMesh apart = shapes::icosphere(3);
  apart.vertices *= 0.5;
  const ClosestPointTree two(
      shapes::joined(apart, shapes::moved(apart, {Matrix3::Identity(), Vector3(3, 0, 0)})));
  EXPECT_THAT(test::error_message<InvalidInput>([&] {
                surface_line(two, columns({{0, 1, 0}, {0, -1, 0.1}, {3, 1, 0}}), {false, 0.01});
              }),
              AllOf(HasSubstr("point 2 to its point 3"), HasSubstr("points between")));
}

TEST(SurfaceLine, RefusesWhatIsNoLine) {
  const ClosestPointTree sphere(shapes::icosphere(1));
  EXPECT_THROW(surface_line(sphere, Points::Zero(3, 1), {false, 0.1}), InvalidInput);
  EXPECT_THROW(surface_line(sphere, Points::Zero(3, 2), {true, 0.1}), InvalidInput);
  EXPECT_THROW(surface_line(sphere, Points::Identity(3, 3), {true, 0}), InvalidInput);
  EXPECT_THROW(surface_line(sphere, Points::Constant(3, 3, std::nan("")), {true, 0.1}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
