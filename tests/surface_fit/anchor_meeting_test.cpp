#include "bespoke/surface_fit/detail/anchor_meeting.h"

#include <gtest/gtest.h>

#include "bespoke/surface_fit/detail/misoriented_faces.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double bound = 3;

/// A ball, and anchors on it that move.
struct MeetingScene {
  TriangleMesh surface = shapes::icosphere(4);
  TargetSurface target{surface};
  Points sources, targets;

  MeetingScene(const Points& at, const Points& moves) : sources(at), targets(at + moves) {}

  AnchorMeeting meet() const {
    return meet_anchors_within({surface, target, sources, targets}, surface.vertices, bound);
  }
};

double largest_stretch(const TriangleMesh& before, const Points& after) {
  double largest = 1;
  for (Eigen::Index face = 0; face < before.faces.cols(); ++face)
    largest = std::max(largest, face_stretch(before.faces, face, before.vertices, after));
  return largest;
}

Points columns(const std::vector<Vector3>& all) {
  Points points(3, static_cast<Eigen::Index>(all.size()));
  for (std::size_t k = 0; k < all.size(); ++k) points.col(static_cast<Eigen::Index>(k)) = all[k];
  return points;
}

// Of one corner of a mouth clicked twice: opposite moves between neighbours would be a spike.
TEST(MeetAnchorsWithin, LetsAnchorsThatContradictEachOtherShareTheBlame) {
  const Vector3 left = Vector3(1, -0.005, 0).normalized(), right = Vector3(1, 0.005, 0).normalized();
  const Vector3 far(0, 0, 1);
  const MeetingScene scene(columns({left, right, far}),
                           columns({{0, -0.1, 0.02}, {0, 0.1, 0.02}, {0, 0, 0.02}}));
  const AnchorMeeting meeting = scene.meet();
  EXPECT_LE(largest_stretch(scene.surface, meeting.vertices), bound);
  EXPECT_GT(meeting.anchor_sigmas[0], 0);
  EXPECT_EQ(meeting.anchor_sigmas[0], meeting.anchor_sigmas[1]);
  EXPECT_EQ(meeting.anchor_sigmas[2], 0);
  // no vertex goes farther than an anchor requires, and the one that nobody contradicts is met.
  EXPECT_LT((meeting.vertices - scene.surface.vertices).colwise().norm().maxCoeff(), 0.12);
  Eigen::Index nearest = 0;
  (scene.surface.vertices.colwise() - far).colwise().norm().minCoeff(&nearest);
  EXPECT_LT(
      (meeting.vertices.col(nearest) - scene.surface.vertices.col(nearest) - Vector3(0, 0, 0.02)).norm(),
      1e-3);
}

TEST(MeetAnchorsWithin, MeetsAnchorsThatAgree) {
  const MeetingScene scene(columns({Vector3(1, 0, 0), Vector3(0, 1, 0)}),
                           columns({{0.02, 0, 0}, {0, 0.02, 0}}));
  const AnchorMeeting meeting = scene.meet();
  EXPECT_EQ(meeting.anchor_sigmas, Eigen::VectorXd::Zero(2));
  EXPECT_EQ(meeting.vertices,
            meet_anchors({scene.surface, scene.target, scene.sources, scene.targets}).vertices);
}

}  // namespace
}  // namespace bespoke
