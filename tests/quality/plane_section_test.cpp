#include "bespoke/quality/plane_section.h"

#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(ClosedSections, OfASphereIsACircle) {
  const TriangleMesh sphere = shapes::icosphere(5);
  for (const double height : {0.0, 0.3, -0.8}) {
    const std::vector<Points> lines = closed_sections(sphere, {{0.1, height, 7}, {0, 3, 0}});
    ASSERT_EQ(lines.size(), 1u);
    const double circle = 2 * std::numbers::pi * std::sqrt(1 - height * height);
    EXPECT_NEAR(line_length(lines[0], true), circle, 2e-3 * circle);
    EXPECT_LE((lines[0].row(1).array() - height).abs().maxCoeff(), 1e-12);
  }
}

TEST(ClosedSections, PutTheLongestFirst) {
  TriangleMesh two = shapes::icosphere(3);
  const TriangleMesh small = two;
  const Eigen::Index count = small.vertices.cols();
  two.vertices.conservativeResize(3, 2 * count);
  two.vertices.rightCols(count) = 0.5 * (small.vertices.colwise() + Vector3(6, 0, 0));
  two.faces.conservativeResize(3, 2 * small.faces.cols());
  two.faces.rightCols(small.faces.cols()) = small.faces.array() + static_cast<int>(count);
  const std::vector<Points> lines = closed_sections(two, {Vector3::Zero(), {0, 1, 0.1}});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NEAR(line_length(lines[1], true) / line_length(lines[0], true), 0.5, 0.01);
}

TEST(ClosedSections, LeaveOutLinesThatEndAtABoundary) {
  TriangleMesh open = shapes::icosphere(3);
  open.faces = open.faces.leftCols(open.faces.cols() / 2).eval();
  for (const Points& line : closed_sections(open, {Vector3::Zero(), {0.2, 1, 0.3}}))
    EXPECT_GT(line.cols(), 2);
  EXPECT_TRUE(closed_sections(open, {{0, 5, 0}, {0, 1, 0}}).empty());
}

TEST(ClosedSections, RefuseAPlaneThatIsNone) {
  const TriangleMesh sphere = shapes::icosphere(1);
  EXPECT_THROW(closed_sections(sphere, {Vector3::Zero(), Vector3::Zero()}), InvalidInput);
  EXPECT_THROW(closed_sections(sphere, {Vector3::Constant(std::nan("")), {0, 1, 0}}), InvalidInput);
}

TEST(LineLength, AddsTheClosingPieceOfALoop) {
  Points square(3, 4);
  square << 0, 2, 2, 0, 0, 0, 2, 2, 0, 0, 0, 0;
  EXPECT_EQ(line_length(square, false), 6);
  EXPECT_EQ(line_length(square, true), 8);
  EXPECT_EQ(line_length(Points(3, 0), true), 0);
}

}  // namespace
}  // namespace bespoke
