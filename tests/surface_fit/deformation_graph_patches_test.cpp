#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/surface_fit/detail/deformation_graph_fit.h"
#include "support/error_message.h"
#include "support/fitting_scene.h"
#include "support/potato.h"

namespace bespoke {
namespace {

using shapes::bend;
using shapes::potato;
using ::testing::AllOf;
using ::testing::HasSubstr;

const Vector3 top = Vector3(1, 2, 6).normalized();  // where the bump sits
constexpr double foot = 0.35;                       // radians from its middle to where it begins
constexpr double rounding = 1e-12;                  // of models of size 2: what is fitted lies on the target

double angle_from_top(const Vector3& x) { return std::acos(std::clamp(x.normalized().dot(top), -1.0, 1.0)); }

/// The potato with a bump of this height.
TriangleMesh bumped(int levels, double height) {
  TriangleMesh mesh = potato(levels);
  for (auto&& x : mesh.vertices.colwise()) {
    const double angle = angle_from_top(x) / foot;
    if (angle < 1) x += height * std::pow(1 - angle * angle, 2) * x.normalized();
  }
  return mesh;
}

/// The faces of a potato within the bump and a little around it, before it was bent.
FacePatches bump_of(const TriangleMesh& mesh, bool exclude) {
  FacePatches patches;
  for (const auto& face : mesh.faces.colwise()) {
    bool is_near = true;
    for (const int vertex : face) is_near = is_near && angle_from_top(mesh.vertices.col(vertex)) < 1.2 * foot;
    patches.of_face.push_back(is_near && exclude ? FacePatches::excluded : FacePatches::none);
  }
  return patches;
}

/// A potato onto a bent one, each with a bump of some height, and twelve exact anchors.
test::FittingScene scene_of(double source_bump, double target_bump) {
  test::FittingScene scene{bumped(4, source_bump), bumped(5, target_bump)};
  scene.source_patches = bump_of(scene.source, source_bump > 0);
  scene.target_patches = bump_of(scene.target, target_bump > 0);
  for (auto&& x : scene.target.vertices.colwise()) x = bend(x);
  scene.anchor_sources = scene.source.vertices.leftCols(12);
  scene.anchor_targets = scene.anchor_sources;
  for (auto&& x : scene.anchor_targets.colwise()) x = bend(x);
  scene.anchor_weights = Eigen::VectorXd::Constant(12, std::numeric_limits<double>::infinity());
  return scene;
}

test::FittingScene without_patches(test::FittingScene scene) {
  scene.source_patches = {};
  scene.target_patches = {};
  return scene;
}

/// Largest distance of fitted vertices from the bent potato without a bump; of the vertices near the bump, or
/// of the others.
double farthest_off(const SurfaceFit& fit, bool near_bump) {
  const TriangleMesh plain = potato(4);
  const ClosestPointTree surface(scene_of(0, 0).target);
  double largest = 0;
  for (Eigen::Index i = 0; i < plain.vertices.cols(); ++i)
    if ((angle_from_top(plain.vertices.col(i)) < 1.5 * foot) == near_bump)
      largest = std::max(largest, std::sqrt(surface.closest(fit.vertices.col(i))->squared_distance));
  return largest;
}

TEST(ExcludedPatch, OfTheTargetAttractsNothing) {
  const double height = 0.2;
  const test::FittingScene scene = scene_of(0, height);
  const SurfaceFit excluded = scene.fit(), drawn = without_patches(scene).fit();
  // Where the bump was, the source goes on as it does around it.
  EXPECT_GT(farthest_off(drawn, true), 0.8 * height);
  EXPECT_LT(farthest_off(excluded, true), 0.1 * height);
  EXPECT_LT(farthest_off(excluded, false), rounding);
  ASSERT_FALSE(excluded.summary.excluded_vertices.empty());
  for (const int vertex : excluded.summary.excluded_vertices) {
    EXPECT_LT(angle_from_top(scene.source.vertices.col(vertex)), 1.5 * foot);
    EXPECT_EQ(excluded.confidence[static_cast<std::size_t>(vertex)], 0);
  }
  EXPECT_THAT(to_string(excluded.summary), HasSubstr("without counterpart since patches exclude it"));
  EXPECT_TRUE(drawn.summary.excluded_vertices.empty());
}

TEST(ExcludedPatch, OfTheTargetCanHaveAnyShape) {
  // Also one that folds and passes through the rest.
  test::FittingScene scene = scene_of(0, 0.4);
  const SurfaceFit before = scene.fit();
  std::vector<char> is_kept(static_cast<std::size_t>(scene.target.vertices.cols()), 0);
  for (Eigen::Index face = 0; face < scene.target.faces.cols(); ++face)
    if (scene.target_patches.of_face[static_cast<std::size_t>(face)] != FacePatches::excluded)
      for (const int vertex : scene.target.faces.col(face)) is_kept[static_cast<std::size_t>(vertex)] = 1;
  for (Eigen::Index i = 0; i < scene.target.vertices.cols(); ++i)
    if (!is_kept[static_cast<std::size_t>(i)]) scene.target.vertices.col(i) *= std::sin(double(i));
  const SurfaceFit after = scene.fit();
  EXPECT_EQ(after.vertices, before.vertices);
  EXPECT_EQ(after.confidence, before.confidence);
}

TEST(ExcludedPatch, OfTheSourceKeepsItsShape) {
  const double height = 0.3;
  const test::FittingScene scene = scene_of(height, 0);
  const SurfaceFit excluded = scene.fit(), drawn = without_patches(scene).fit();
  Eigen::Index tip = 0;
  (scene.source.vertices.transpose() * top).maxCoeff(&tip);
  const Vector3 below = bend(potato(4).vertices.col(tip));
  EXPECT_LT((drawn.vertices.col(tip) - below).norm(), 0.25 * height);
  EXPECT_GT((excluded.vertices.col(tip) - below).norm(), 0.75 * height);
  EXPECT_EQ(excluded.confidence[static_cast<std::size_t>(tip)], 0);
  EXPECT_LT(farthest_off(excluded, false), rounding);
  EXPECT_THAT(excluded.summary.excluded_vertices, ::testing::Contains(static_cast<int>(tip)));
}

TEST(ExcludedPatch, OfNothingChangesNoBit) {
  test::FittingScene scene = scene_of(0, 0);
  EXPECT_EQ(scene.fit().vertices, without_patches(scene).fit().vertices);
}

TEST(Patches, AreRefusedWhereTheyDoNotBelong) {
  test::FittingScene scene = scene_of(0, 0.2);
  SurfaceFitOptions laplacian;
  laplacian.method = SurfaceFitMethod::laplacian;
  EXPECT_THAT(test::error_message<InvalidInput>([&] { scene.fit(laplacian); }),
              AllOf(HasSubstr("\"deformation-graph\" alone"), HasSubstr("leave the patches out")));
  scene.target_patches.of_face.pop_back();
  EXPECT_THROW(scene.fit(), InvalidInput);
}

}  // namespace
}  // namespace bespoke
