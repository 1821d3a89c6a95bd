#include "bespoke/registration/detail/matched_parts.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh ball(int level, const Vector3& centre, const Vector3& half_axes) {
  TriangleMesh mesh = shapes::icosphere(level);
  mesh.vertices = (half_axes.asDiagonal() * mesh.vertices).colwise() + centre;
  return mesh;
}

/// A skin around two bones, the joint at some height, the parts in some order.
TriangleMesh limb(double joint, bool bones_first, int level) {
  const TriangleMesh skin = ball(level + 1, {0, 0, 0}, {3, 3, 10});
  const double top = (8 + joint) / 2, bottom = (joint - 8) / 2;
  const TriangleMesh upper = ball(level, {0, 0, top}, {1, 1, 8 - top - 0.1});
  const TriangleMesh lower = ball(level, {0, 0, bottom}, {1, 1, bottom + 8 - 0.1});
  if (bones_first) return shapes::joined(shapes::joined(lower, upper), skin);
  return shapes::joined(skin, shapes::joined(upper, lower));
}

TEST(MatchParts, FindsBonesWhoseJointLiesElsewhere) {
  const TriangleMesh source = limb(0, false, 2), target = limb(1.5, true, 3);
  const MatchedParts parts = match_parts(source, source.vertices, target);
  ASSERT_TRUE(parts.correspond());
  EXPECT_EQ(parts.source_parts, 3u);
  // Skin, upper, lower on the source; lower, upper, skin on the target.
  EXPECT_EQ(parts.source.of_face.front(), parts.target.of_face.back());
  EXPECT_EQ(parts.source.of_face.back(), parts.target.of_face.front());
  EXPECT_EQ(parts.source.sizes, (std::vector<std::size_t>{1280, 320, 320}));
  EXPECT_EQ(parts.target.sizes, (std::vector<std::size_t>{5120, 1280, 1280}));
  EXPECT_NE(to_string(parts).find("onto its counterpart"), std::string::npos);
}

TEST(MatchParts, LeavesPartsThatDoNotCorrespond) {
  const TriangleMesh source = limb(0, false, 1);
  const TriangleMesh more = shapes::joined(source, ball(1, {0, 0, 30}, {1, 1, 1}));
  EXPECT_FALSE(match_parts(source, source.vertices, more).correspond());
  const TriangleMesh displaced =
      shapes::joined(ball(2, {0, 0, 0}, {3, 3, 10}),
                     shapes::joined(ball(1, {0, 0, 4}, {1, 1, 4}), ball(1, {40, 0, 0}, {1, 1, 4})));
  const MatchedParts parts = match_parts(source, source.vertices, displaced);
  EXPECT_FALSE(parts.correspond());
  EXPECT_NE(to_string(parts).find("do not correspond"), std::string::npos);
}

TEST(MatchParts, SaysNothingOfOnePart) {
  const TriangleMesh ball = shapes::icosphere(2);
  EXPECT_FALSE(match_parts(ball, ball.vertices, ball).correspond());
  EXPECT_EQ(part_count(ball), 1u);
  EXPECT_EQ(part_count({ball.vertices, Faces(3, 0)}), 0u);
}

}  // namespace
}  // namespace bespoke
