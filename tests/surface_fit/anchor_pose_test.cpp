#include "bespoke/surface_fit/graph/anchor_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/bent_tube.h"

namespace bespoke {
namespace {

using shapes::elbow;

constexpr double bend_degrees = 110;

Vector3 bent(const Vector3& x) { return shapes::bent(x, bend_degrees); }

struct BentTube {
  TriangleMesh rest = shapes::tube();
  Points sources = rest.vertices(Eigen::all, shapes::tube_marks());
  Points targets = sources;
  Eigen::VectorXd sigmas = Eigen::VectorXd::Zero(8);

  BentTube() {
    for (auto&& x : targets.colwise()) x = bent(x);
  }
  PosingByAnchors posing() const { return PosingByAnchors({rest, sources, targets, sigmas}); }
};

TEST(PosingByAnchors, MovesNothingWithoutAnchorsOrWithAnchorsInPlace) {
  BentTube scene;
  scene.targets = scene.sources;
  EXPECT_LT((scene.posing().bent().vertices - scene.rest.vertices).cwiseAbs().maxCoeff(), 1e-9);
  const Points none(3, 0);
  const Eigen::VectorXd no_sigmas(0);
  const AnchorPose still = PosingByAnchors({scene.rest, none, none, no_sigmas}).bent();
  EXPECT_EQ(still.vertices, scene.rest.vertices);
}

TEST(PosingByAnchors, TurnsALimbBeyondARightAngleWithoutShrinkingIt) {
  const BentTube scene;
  const PosingByAnchors posing = scene.posing();
  EXPECT_NEAR(posing.rotation_spread() * 180 / std::numbers::pi, bend_degrees / 2, 0.2 * bend_degrees);
  const AnchorPose pose = posing.bent();
  EXPECT_LT((pose.anchor_sources - scene.targets).colwise().norm().maxCoeff(), 0.02);
  for (Eigen::Index i = 0; i < pose.vertices.cols(); ++i) {
    const double way = std::abs(scene.rest.vertices(0, i) - elbow);
    if (way > 1) {
      EXPECT_LT((pose.vertices.col(i) - bent(scene.rest.vertices.col(i))).norm(), 0.1) << i;
    }
  }
}

TEST(PosingByAnchors, LetsAnInaccurateAnchorPullLess) {
  BentTube scene;
  scene.targets = scene.sources;
  scene.targets.col(3) += Vector3(0, 0.4, 0);
  double last = 1;
  for (const double sigma : {0.0, 0.2, 1.0}) {
    scene.sigmas[3] = sigma;
    const double pulled = (scene.posing().bent().anchor_sources.col(3) - scene.sources.col(3)).norm();
    EXPECT_LT(pulled, last);
    last = pulled;
  }
}

}  // namespace
}  // namespace bespoke
