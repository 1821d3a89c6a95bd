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

/// A sphere of the given radius and centre.
TriangleMesh sphere_at(const Vector3& centre, double radius) {
  return shapes::moved(shapes::icosphere(4), {radius * Matrix3::Identity(), centre});
}

TEST(ClosedSections, PutTheLongestFirst) {
  const TriangleMesh two = shapes::joined(sphere_at({6, 0, 0}, 0.5), sphere_at({0, 0, 0}, 1));
  const std::vector<Points> lines = closed_sections(two, {Vector3::Zero(), {0, 1, 0.1}});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_NEAR(line_length(lines[1], true) / line_length(lines[0], true), 0.5, 0.01);
}

TEST(ClosedSections, LeaveOutLinesThatEndAtABoundary) {
  TriangleMesh cap = shapes::icosphere(4);  // without what lies beyond x = 0.5
  Faces kept(3, 0);
  for (Eigen::Index i = 0; i < cap.faces.cols(); ++i)
    if (cap.vertices.row(0)(cap.faces.col(i)).maxCoeff() < 0.5) {
      kept.conservativeResize(3, kept.cols() + 1);
      kept.col(kept.cols() - 1) = cap.faces.col(i);
    }
  cap.faces = kept;
  EXPECT_TRUE(closed_sections(cap, {Vector3::Zero(), {0, 1, 0}}).empty());
  EXPECT_EQ(closed_sections(cap, {Vector3::Zero(), {1, 0, 0}}).size(), 1u);
  EXPECT_TRUE(closed_sections(cap, {{0, 5, 0}, {0, 1, 0}}).empty());
}

TEST(ClosedSections, CrossSeamsWhereVerticesAreSplit) {
  const TriangleMesh sphere = shapes::icosphere(3);
  TriangleMesh split{Points(3, 3 * sphere.faces.cols()), Faces(3, sphere.faces.cols())};
  for (Eigen::Index i = 0; i < sphere.faces.size(); ++i) {
    split.vertices.col(i) = sphere.vertices.col(sphere.faces(i));
    split.faces(i) = static_cast<int>(i);
  }
  const Plane plane{{0, 0.2, 0}, {0.1, 1, 0}};
  const std::vector<Points> lines = closed_sections(split, plane);
  ASSERT_EQ(lines.size(), 1u);
  EXPECT_NEAR(line_length(lines[0], true), line_length(closed_sections(sphere, plane)[0], true), 1e-12);
}

TEST(SectionAboutPoint, IsTheOneThatGoesRoundIt) {
  // Two legs, the second thicker and with a hollow.
  const TriangleMesh legs = shapes::joined(
      sphere_at({0, 0, 0}, 1), shapes::joined(sphere_at({5, 0, 0}, 2), sphere_at({5, 0, 0}, 0.4)));
  const auto girth = [&](const Vector3& point) {
    return line_length(section_about_point(legs, {point, {0, 1, 0}}).value(), true) / (2 * std::numbers::pi);
  };
  EXPECT_NEAR(girth({0.3, 0, 0.2}), 1, 0.01);
  EXPECT_NEAR(girth({5, 0, 0}), 2, 0.01);   // round the hollow and the leg: the longer one
  EXPECT_NEAR(girth({-2, 0, 0}), 1, 0.01);  // round none: the nearest
  EXPECT_NEAR(girth({2.5, 0, 0}), 2, 0.01);
  EXPECT_FALSE(section_about_point(legs, {{0, 4, 0}, {0, 1, 0}}));
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
