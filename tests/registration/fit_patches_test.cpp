#include "bespoke/registration/fit_patches.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/error.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/summary_json.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const Vector3 radii(1.1, 0.9, 1.2);

/// The circle of the unit sphere around a direction at this many radians from it, stretched.
Points circle_around(const Vector3& direction, double radius, const Vector3& stretch) {
  constexpr int points = 200;
  const Vector3 u = direction.unitOrthogonal(), v = direction.cross(u);
  Points circle(3, points);
  for (int i = 0; i < points; ++i) {
    const double angle = 2 * std::numbers::pi * i / points;
    circle.col(i) = stretch.cwiseProduct(std::cos(radius) * direction +
                                         std::sin(radius) * (std::cos(angle) * u + std::sin(angle) * v));
  }
  return circle;
}

/// Faces of a stretched sphere with all corners within so many radians of a direction.
std::vector<int> faces_around(const TriangleMesh& mesh, const Vector3& direction, double radius,
                              const Vector3& stretch) {
  std::vector<int> faces;
  for (int face = 0; face < mesh.faces.cols(); ++face) {
    bool is_within = true;
    for (const int vertex : mesh.faces.col(face)) {
      const Vector3 x = mesh.vertices.col(vertex).cwiseQuotient(stretch).normalized();
      is_within = is_within && x.dot(direction) > std::cos(radius);
    }
    if (is_within) faces.push_back(face);
  }
  return faces;
}

/// A sphere and an ellipsoid with a face on the front that is larger and higher on the target, where nothing
/// of its shape tells.
struct PatchScene {
  const Vector3 front = Vector3(1, 0, 0.1).normalized(), front_b = Vector3(1, 0.05, 0.25).normalized();
  const double radius = 0.5, radius_b = 0.62;
  TriangleMesh source = shapes::icosphere(4);
  TriangleMesh target = shapes::icosphere(5);
  Anchors anchors;
  FitOptions options;

  PatchScene() {
    const Vector3 one(1, 1, 1);
    target.vertices = radii.asDiagonal() * target.vertices;
    for (const Vector3& x :
         {Vector3(0, 0, 1), Vector3(0, 0, -1), Vector3(-1, 0, 0), Vector3(0, 1, 0), Vector3(0, -1, 0)})
      anchors.pairs.push_back({"", x, radii.cwiseProduct(x), std::numeric_limits<double>::infinity(), 0.0});
    anchors.patches = {{"face",
                        {circle_around(front, radius, one), {}},
                        {circle_around(front_b, radius_b, radii), {}},
                        false}};
    options.lambda = 0.4;
    options.fit_tolerance = 0.002 * diagonal(source.vertices);
  }

  FittedMapping fit() const { return fit_mapping({source, target, anchors}, options); }
};

/// Where the map takes vertices that lie this much within the patch of the source, or without it: the
/// smallest margin by which they are on the right side on the target, radians.
double min_margin(const PatchScene& scene, const FittedMapping& fit, double clear) {
  const Points mapped = fit.target_from_source * (*fit.elastic)(scene.source.vertices);
  double least = 10;
  for (Eigen::Index i = 0; i < mapped.cols(); ++i) {
    const auto angle = [](const Vector3& x, const Vector3& y) {
      return std::acos(std::clamp(x.dot(y), -1.0, 1.0));
    };
    const double inside = scene.radius - angle(scene.source.vertices.col(i).normalized(), scene.front);
    const double inside_b =
        scene.radius_b - angle(mapped.col(i).cwiseQuotient(radii).normalized(), scene.front_b);
    if (std::abs(inside) > clear) least = std::min(least, inside > 0 ? inside_b : -inside_b);
  }
  return least;
}

TEST(FitPatches, PutBorderOntoBorderAndInsideInto) {
  const PatchScene scene;
  const FittedMapping fit = scene.fit();
  ASSERT_EQ(fit.summary.patches.size(), 1u);
  ASSERT_TRUE(fit.summary.patches[0].largest_distance);
  EXPECT_LT(*fit.summary.patches[0].largest_distance, 2 * scene.options.fit_tolerance);
  EXPECT_GT(min_margin(scene, fit, 0.02), 0);
  EXPECT_TRUE(fit.summary.curves.empty());
  EXPECT_EQ(fit.anchor_residual.size(), scene.anchors.pairs.size());

  PatchScene without;
  without.anchors.patches.clear();
  EXPECT_LT(min_margin(scene, without.fit(), 0.02), -0.1);
}

/// Of some faces.
double longest_edge(const Points& vertices, const Faces& faces, const std::vector<int>& chosen) {
  double longest = 0;
  for (const int face : chosen)
    for (int k = 0; k < 3; ++k)
      longest =
          std::max(longest, (vertices.col(faces(k, face)) - vertices.col(faces((k + 1) % 3, face))).norm());
  return longest;
}

// A border of faces goes to and fro by about an edge, differently on both meshes.
TEST(FitPatches, OfFacesMeetTheirBordersWithinAnEdgeAsCarried) {
  PatchScene scene;
  AnchorPatch& face = scene.anchors.patches[0];
  face.a = {Points(3, 0), faces_around(scene.source, scene.front, scene.radius, Vector3(1, 1, 1))};
  face.b = {Points(3, 0), faces_around(scene.target, scene.front_b, scene.radius_b, radii)};
  const FittedMapping fit = scene.fit();
  const Points carried = fit.target_from_source * (*fit.elastic)(scene.source.vertices);
  EXPECT_LT(fit.summary.patches[0].largest_distance.value(),
            longest_edge(carried, scene.source.faces, face.a.faces));
  EXPECT_EQ(fit.summary.patches[0].source_faces, face.a.faces.size());
  EXPECT_EQ(fit.summary.patches[0].target_faces, face.b.faces.size());
  const auto lines = stage_lines(fit.summary, scene.anchors);
  const auto told =
      std::find_if(lines.begin(), lines.end(), [](const auto& line) { return line.name == "patches"; });
  ASSERT_NE(told, lines.end());
  EXPECT_THAT(told->line, AllOf(HasSubstr("\"face\""), HasSubstr("border at most")));
  EXPECT_EQ(stages_json(fit.summary, scene.anchors).back().json["patches"][0]["name"], "face");
}

TEST(FitPatches, NeedPairsAndNoGivenFit) {
  PatchScene scene;
  EXPECT_THROW(fit_mapping({scene.source, scene.source, scene.anchors, &scene.source}, scene.options),
               InvalidInput);
  scene.anchors.pairs.clear();
  EXPECT_THAT(test::error_message<InvalidInput>([&] { scene.fit(); }), HasSubstr("anchor pairs"));
}

TEST(FitPatches, AreRefusedWhereThePairsSayThatTheOtherSideWasMeant) {
  PatchScene scene;
  const Vector3 one(1, 1, 1), up(0, 0, 1);
  // Less than half of the source, more than half of the target.
  scene.anchors.patches[0] = {
      "head", {circle_around(up, 1.3, one), {}}, {circle_around(up, 1.85, radii), {}}, false};
  EXPECT_THAT(
      test::error_message<InvalidInput>([&] { fit_patches(scene.anchors, scene.source, scene.target); }),
      AllOf(HasSubstr("\"head\""), HasSubstr("give its faces")));
  scene.anchors.patches[0].b.border = circle_around(up, 1.2, radii);
  const FitPatches found = fit_patches(scene.anchors, scene.source, scene.target);
  EXPECT_EQ(found.borders.size(), 1u);
  EXPECT_EQ(found.found.size(), 1u);
}

TEST(FitPatches, AreNoneWithoutAny) {
  PatchScene scene;
  scene.anchors.patches.clear();
  const FitPatches found = fit_patches(scene.anchors, scene.source, scene.target);
  EXPECT_TRUE(found.source.is_empty() && found.target.is_empty() && found.borders.empty() &&
              found.found.empty());
}

}  // namespace
}  // namespace bespoke
