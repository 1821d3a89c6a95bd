#include "bespoke/surface_fit/detail/anchor_pose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double elbow = 2, bend_degrees = 110;

/// A tube of radius 0.2 along x from 0 to 4, open at both ends.
TriangleMesh tube() {
  constexpr int around = 12, along = 80;
  TriangleMesh mesh;
  mesh.vertices.resize(3, around * (along + 1));
  mesh.faces.resize(3, 2 * around * along);
  for (int ring = 0; ring <= along; ++ring)
    for (int k = 0; k < around; ++k) {
      const double angle = 2 * std::numbers::pi * k / around;
      mesh.vertices.col(ring * around + k) << 4.0 * ring / along, 0.2 * std::cos(angle),
          0.2 * std::sin(angle);
    }
  for (int ring = 0; ring < along; ++ring)
    for (int k = 0; k < around; ++k) {
      const int a = ring * around + k, b = ring * around + (k + 1) % around;
      mesh.faces.col(2 * (ring * around + k)) << a, b, a + around;
      mesh.faces.col(2 * (ring * around + k) + 1) << b, b + around, a + around;
    }
  return mesh;
}

/// What lies beyond the elbow turns about it.
Vector3 bent(const Vector3& x) {
  if (x[0] <= elbow) return x;
  const Vector3 joint(elbow, 0, 0);
  return joint +
         Eigen::AngleAxisd(bend_degrees * std::numbers::pi / 180, Vector3::UnitZ()) * Vector3(x - joint);
}

struct BentTube {
  TriangleMesh rest = tube();
  Points sources, targets;
  Eigen::VectorXd sigmas;

  BentTube() : sources(3, 8), targets(3, 8), sigmas(Eigen::VectorXd::Zero(8)) {
    const int rings[] = {0, 25, 55, 80};
    for (int k = 0; k < 8; ++k) sources.col(k) = rest.vertices.col(rings[k / 2] * 12 + 6 * (k % 2));
    for (int k = 0; k < 8; ++k) targets.col(k) = bent(sources.col(k));
  }
  AnchorPose pose() const {
    return pose_by_anchors({rest, sources, targets, sigmas, diagonal(rest.vertices)});
  }
};

TEST(PoseByAnchors, MovesNothingWithoutAnchorsOrWithAnchorsInPlace) {
  BentTube scene;
  scene.targets = scene.sources;
  EXPECT_LT((scene.pose().vertices - scene.rest.vertices).cwiseAbs().maxCoeff(), 1e-9);
  const Points none(3, 0);
  const Eigen::VectorXd no_sigmas(0);
  const AnchorPose still = pose_by_anchors({scene.rest, none, none, no_sigmas, 4});
  EXPECT_EQ(still.vertices, scene.rest.vertices);
}

TEST(PoseByAnchors, TurnsALimbBeyondARightAngleWithoutShrinkingIt) {
  const BentTube scene;
  const AnchorPose pose = scene.pose();
  EXPECT_NEAR(pose.rotation_spread * 180 / std::numbers::pi, bend_degrees / 2, 0.2 * bend_degrees);
  EXPECT_LT((pose.anchor_sources - scene.targets).colwise().norm().maxCoeff(), 0.02);
  for (Eigen::Index i = 0; i < pose.vertices.cols(); ++i) {
    const double way = std::abs(scene.rest.vertices(0, i) - elbow);
    if (way > 1) {
      EXPECT_LT((pose.vertices.col(i) - bent(scene.rest.vertices.col(i))).norm(), 0.1) << i;
    }
  }
}

TEST(PoseByAnchors, LetsAnInaccurateAnchorPullLess) {
  BentTube scene;
  scene.targets = scene.sources;
  scene.targets.col(3) += Vector3(0, 0.4, 0);
  double last = 1;
  for (const double sigma : {0.0, 0.2, 1.0}) {
    scene.sigmas[3] = sigma;
    const double pulled = (scene.pose().anchor_sources.col(3) - scene.sources.col(3)).norm();
    EXPECT_LT(pulled, last);
    last = pulled;
  }
}

}  // namespace
}  // namespace bespoke
