#include "bespoke/anchors/detail/enclosed_faces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The circle of the unit sphere at a height.
Points circle_at(double height, int points = 90, double direction = 1) {
  Points circle(3, points);
  for (int i = 0; i < points; ++i) {
    const double angle = 0.3 + direction * 2 * std::numbers::pi * i / points;
    const double around = std::sqrt(1 - height * height);
    circle.col(i) = Vector3(around * std::cos(angle), around * std::sin(angle), height);
  }
  return circle;
}

bool contains(const std::vector<int>& sorted, Eigen::Index face) {
  return std::binary_search(sorted.begin(), sorted.end(), static_cast<int>(face));
}

/// Everything above the height is enclosed and nothing below it, except for faces that the line runs through.
void expect_cap_above(const TriangleMesh& sphere, double height, const EnclosedFaces& found) {
  for (Eigen::Index face = 0; face < sphere.faces.cols(); ++face) {
    if (contains(found.crossed, face)) continue;
    double middle = 0;
    for (const int vertex : sphere.faces.col(face)) middle += sphere.vertices(2, vertex) / 3;
    EXPECT_EQ(contains(found.inside, face), middle > height) << "face " << face;
  }
}

/// Corners of every face of its own.
TriangleMesh soup_of(const TriangleMesh& mesh) {
  TriangleMesh soup{mesh.vertices(Eigen::all, mesh.faces.reshaped()), Faces(3, mesh.faces.cols())};
  std::iota(soup.faces.reshaped().begin(), soup.faces.reshaped().end(), 0);
  return soup;
}

TriangleMesh torus(double tube, int around, int along) {
  TriangleMesh mesh{Points(3, around * along), Faces(3, 2 * around * along)};
  for (int i = 0; i < along; ++i)
    for (int j = 0; j < around; ++j) {
      const double u = 2 * std::numbers::pi * i / along, v = 2 * std::numbers::pi * j / around;
      const double radius = 1 + tube * std::cos(v);
      mesh.vertices.col(i * around + j) =
          Vector3(radius * std::cos(u), radius * std::sin(u), tube * std::sin(v));
      const auto at = [&](int k, int l) { return (k % along) * around + l % around; };
      mesh.faces.col(2 * (i * around + j)) << at(i, j), at(i + 1, j), at(i + 1, j + 1);
      mesh.faces.col(2 * (i * around + j) + 1) << at(i, j), at(i + 1, j + 1), at(i, j + 1);
    }
  return mesh;
}

std::string complaint(const TriangleMesh& mesh, const Points& border) {
  return test::error_message<InvalidInput>([&] { enclosed_faces(mesh, border, "patch 0"); });
}

TEST(EnclosedFaces, OfACircleOfASphereAreTheSmallerCap) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const EnclosedFaces cap = enclosed_faces(sphere, circle_at(0.61), "");
  expect_cap_above(sphere, 0.61, cap);
  const EnclosedFaces below = enclosed_faces(sphere, circle_at(-0.61), "");
  for (const int face : below.inside) EXPECT_LT(sphere.vertices(2, sphere.faces(0, face)), -0.5);
  EXPECT_GT(below.inside.size(), 0u);
}

TEST(EnclosedFaces, DoNotDependOnTheWayRoundOrOnHowManyPointsTheLineHas) {
  const TriangleMesh sphere = shapes::icosphere(4);
  for (const int points : {12, 40, 1000})
    for (const double direction : {1.0, -1.0})
      expect_cap_above(sphere, 0.33, enclosed_faces(sphere, circle_at(0.33, points, direction), ""));
}

TEST(EnclosedFaces, AreFoundAcrossSeams) {
  const TriangleMesh sphere = shapes::icosphere(3);
  expect_cap_above(sphere, 0.4, enclosed_faces(soup_of(sphere), circle_at(0.4), ""));
}

TEST(EnclosedFaces, OfALineAlongEdgesAreThoseAroundItsMiddle) {
  const TriangleMesh square = shapes::square_grid(8);
  const Points border{{0.25, 0.75, 0.75, 0.25}, {0.25, 0.25, 0.75, 0.75}, {0, 0, 0, 0}};
  const EnclosedFaces found = enclosed_faces(square, border, "");
  for (Eigen::Index face = 0; face < square.faces.cols(); ++face) {
    const Vector3 middle = square.vertices(Eigen::all, square.faces.col(face)).rowwise().mean();
    if (contains(found.crossed, face)) continue;
    const bool is_within = middle.x() > 0.25 && middle.x() < 0.75 && middle.y() > 0.25 && middle.y() < 0.75;
    EXPECT_EQ(contains(found.inside, face), is_within) << middle.transpose();
  }
}

TEST(EnclosedFaces, AreOfThePieceThatTheLineIsOn) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const TriangleMesh beside = shapes::moved(sphere, {0.2 * Matrix3::Identity(), Vector3(0, 0, 2)});
  const EnclosedFaces found = enclosed_faces(shapes::joined(sphere, beside), circle_at(0.4), "");
  expect_cap_above(sphere, 0.4, found);
  EXPECT_LT(found.inside.back(), sphere.faces.cols());
}

TEST(EnclosedFaces, AreRefusedWhereTheLineEnclosesNothing) {
  const TriangleMesh ring = torus(0.3, 24, 60);
  Points meridian(3, 40);
  for (int i = 0; i < 40; ++i) {
    const double v = 2 * std::numbers::pi * i / 40;
    meridian.col(i) = Vector3(1 + 0.3 * std::cos(v), 0.01, 0.3 * std::sin(v));
  }
  EXPECT_THAT(complaint(ring, meridian), AllOf(HasSubstr("patch 0: "), HasSubstr("does not separate")));
  const TriangleMesh sphere = shapes::icosphere(3);
  EXPECT_THAT(complaint(sphere, circle_at(0)), HasSubstr("two about equal parts"));
  const Vector3 middle = sphere.vertices(Eigen::all, sphere.faces.col(7)).rowwise().mean();
  const Points tiny = (0.001 * circle_at(0)).colwise() + middle;
  EXPECT_THAT(complaint(sphere, tiny), HasSubstr("encloses no face"));
}

TEST(EnclosedFaces, AreRefusedWhereTheLineLeavesTheSurface) {
  const TriangleMesh sphere = shapes::icosphere(3);
  EXPECT_THAT(complaint(sphere, 100 * circle_at(0.5)), HasSubstr("leaves the surface near"));
  EXPECT_THAT(complaint(sphere, circle_at(0.1, 3)), HasSubstr("more points along it"));
  // Half of a circle: the closing line cuts through the sphere.
  EXPECT_THAT(complaint(sphere, circle_at(0.3).leftCols(45)), HasSubstr("leaves the surface near"));
}

}  // namespace
}  // namespace bespoke
