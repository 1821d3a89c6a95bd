#include "bespoke/registration/fit_unanchored.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/product/mesh_io.h"
#include "samples.h"
#include "support/pocketed_ball.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

/// Made once: the generator takes seconds.
const Sample& glove() {
  static const Sample sample = make_sample("glove");
  return sample;
}

const Sample& shoe() {
  static const Sample sample = make_sample("shoe");
  return sample;
}

TriangleMesh mirrored_sample(TriangleMesh mesh) {
  mesh.vertices.row(0) *= -1;
  mesh.faces.row(0).swap(mesh.faces.row(1));
  return mesh;
}

/// Mean distance of the anchors' counterparts from where the fit takes them, % of the target's diagonal.
double anchor_error(const UnanchoredFit& fit, const TriangleMesh& source, const SampleTarget& target) {
  const ClosestPointTree tree(source);
  const Points placed = fit.target_from_source * fit.surface.vertices;
  double sum = 0;
  for (const AnchorPair& pair : target.anchors) {
    const SurfacePoint foot = *tree.closest(pair.a);
    Vector3 place = Vector3::Zero();
    for (int k = 0; k < 3; ++k) place += foot.barycentric[k] * placed.col(source.faces(k, foot.face));
    sum += (place - pair.b).norm();
  }
  return 100 * sum / double(target.anchors.size()) / diagonal(target.mesh.vertices);
}

TEST(FitUnanchored, FindsAHandWhereverItLies) {
  const SampleTarget& target = glove().targets.front();
  SampleTarget moved = target;
  const Matrix3 turn = test::random_rotation(5);
  const auto move = [&](const Vector3& x) -> Vector3 { return 2.5 * turn * x + Vector3(10, -4, 7); };
  for (auto&& vertex : moved.mesh.vertices.colwise()) vertex = move(vertex);
  for (AnchorPair& pair : moved.anchors) pair.b = move(pair.b);

  const UnanchoredFit here = fit_unanchored(glove().source, target.mesh, {});
  const UnanchoredFit there = fit_unanchored(glove().source, moved.mesh, {});
  EXPECT_LT(anchor_error(here, glove().source, target), 2);
  EXPECT_LT(anchor_error(there, glove().source, moved), 2);
  EXPECT_EQ(here.summary.from_deformed, there.summary.from_deformed);
  EXPECT_NEAR(there.summary.alignment.misfit, here.summary.alignment.misfit,
              0.01 * here.summary.alignment.misfit);
}

/// A ball with three limbs of different lengths: what lies within is carried along.
TriangleMesh with_limbs(TriangleMesh ball) {
  for (auto&& vertex : ball.vertices.colwise()) {
    const Vector3 direction = vertex.normalized();
    const auto limb = [&](const Vector3& end, double height, double width) {
      return height * std::exp((direction.dot(end.normalized()) - 1) / (width * width));
    };
    vertex *=
        1 + limb({1, 0.2, -0.3}, 2.4, 0.4) + limb({-0.3, 1, -0.2}, 1.4, 0.3) + limb({0, -1, 0.4}, 0.7, 0.5);
  }
  return ball;
}

/// Largest height of the points over a surface, mesh units; negative where all lie within.
double farthest_out(const TriangleMesh& surface, const Points& points) {
  const ClosestPointTree tree(surface);
  const Points normals = face_normals(surface);
  double most = -std::numeric_limits<double>::infinity();
  for (const auto& x : points.colwise()) {
    const SurfacePoint foot = *tree.closest(x);
    most = std::max(most, (x - foot.point).dot(normals.col(foot.face)));
  }
  return most;
}

TEST(FitUnanchored, KeepsAMouthThatTheTargetLacksInsideAndReachesAllOfATargetWithOne) {
  const TriangleMesh pocketed = shapes::pocketed_ball(9 * std::numbers::pi / 180);
  const TriangleMesh with_mouth = with_limbs(pocketed), smooth = with_limbs(shapes::icosphere(4));
  const double unit = diagonal(smooth.vertices);

  const UnanchoredFit fit = fit_unanchored(with_mouth, smooth, {});
  const Points placed = fit.target_from_source * fit.surface.vertices;
  std::vector<int> cavity, outside;
  for (int i = 0; i < placed.cols(); ++i)
    (shapes::in_pocket(pocketed.vertices.col(i)) ? cavity : outside).push_back(i);
  EXPECT_LT(farthest_out(smooth, placed(Eigen::all, cavity)), 0.005 * unit);
  const Points apart = (placed - with_mouth.vertices)(Eigen::all, outside);
  EXPECT_LT(apart.colwise().norm().mean(), 0.01 * unit);

  const UnanchoredFit back = fit_unanchored(smooth, with_mouth, {});
  const Points there = back.target_from_source * back.surface.vertices - smooth.vertices;
  EXPECT_LT(there.colwise().norm().mean(), 0.01 * unit);
}

TEST(FitUnanchored, RefusesAMirroredHand) {
  EXPECT_THROW(fit_unanchored(glove().source, mirrored_sample(glove().targets.front().mesh), {}),
               SolverError);
}

TEST(FitUnanchored, RefusesAHandOnAFootAndSaysWhatToDo) {
  try {
    fit_unanchored(glove().source, shoe().targets.front().mesh, {});
    FAIL() << "a hand was registered to a foot";
  } catch (const SolverError& error) {
    EXPECT_THAT(error.what(), HasSubstr("give at least 4 anchors"));
  }
}

/// What is recorded of a pair without anchors; null where nothing is.
nlohmann::json recorded(const std::string& folder) {
  const auto all = nlohmann::json::parse(std::ifstream(BESPOKE_SOURCE_DIR "/tests/accuracy/recorded.json"));
  for (const nlohmann::json& pair : all["without_anchors"])
    if (folder.starts_with(pair["id"].get<std::string>())) return pair;
  return nullptr;
}

/// Real pairs whose true correspondence is known.
class UnanchoredSharedCase : public ::testing::TestWithParam<const char*> {};

TEST_P(UnanchoredSharedCase, IsRightOrRefused) {
  const fs::path folder = fs::path(BESPOKE_SHARED_DIR) / "cases" / GetParam();
  if (!fs::exists(folder)) GTEST_SKIP() << folder << " is absent";
  const TriangleMesh source = read_triangle_mesh(folder / "reference_a.obj");
  const TriangleMesh target = read_triangle_mesh(folder / "reference_b.obj");
  Points truth(3, source.vertices.cols());
  std::ifstream file(folder / "gt_a_on_b.xyz");
  for (Eigen::Index i = 0; i < truth.size(); ++i) file >> truth(i);
  ASSERT_TRUE(file);
  const nlohmann::json expected = recorded(GetParam());
  ASSERT_FALSE(expected.is_null()) << "tests/accuracy/recorded.json has no pair " << GetParam();
  if (expected.contains("refused")) {
    EXPECT_THROW(fit_unanchored(source, target, {}), SolverError);
    return;
  }
  const UnanchoredFit fit = fit_unanchored(source, target, {});
  const Points off = fit.target_from_source * fit.surface.vertices - truth;
  const double mean = 100 * off.colwise().norm().mean() / diagonal(source.vertices);
  std::cout << GetParam() << ": mean error " << mean << " %, " << to_string(fit.summary) << "\n";
  EXPECT_LE(std::round(1000 * mean), std::round(1000 * expected["mean"].get<double>()));
}

INSTANTIATE_TEST_SUITE_P(Cases, UnanchoredSharedCase,
                         ::testing::Values("d00_similarity_head", "d01_body_dress", "d02_body_suit",
                                           "d03_head_glasses", "d04_hand_glove", "d05_foot_shoe",
                                           "d06_head_hat", "d07_hard_toddler", "d08_pose_body",
                                           "d10_hand_curl"));

}  // namespace
}  // namespace bespoke
