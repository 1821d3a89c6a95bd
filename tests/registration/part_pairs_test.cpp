#include "bespoke/registration/detail/part_pairs.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh ball(const Vector3& centre, const Vector3& half_axes) {
  TriangleMesh mesh = shapes::icosphere(3);
  mesh.vertices = (half_axes.asDiagonal() * mesh.vertices).colwise() + centre;
  return mesh;
}

/// A skin around two bones, the joint at some height.
TriangleMesh limb(double joint) {
  const double gap = 0.1, end = 8;
  const TriangleMesh skin = ball({0, 0, 0}, {3, 3, 10});
  const TriangleMesh upper = ball({0, 0, (end + joint) / 2}, {1, 1, (end - joint) / 2 - gap});
  const TriangleMesh lower = ball({0, 0, (joint - end) / 2}, {1, 1, (joint + end) / 2 - gap});
  return shapes::joined(skin, shapes::joined(upper, lower));
}

// The two limbs' vertices correspond, so that the truth is known.
TEST(PartPairs, LeadBonesToWhereTheJointIs) {
  const TriangleMesh source = limb(0), target = limb(1.5);
  const MatchedParts parts = match_parts(source, source.vertices, target);
  const Points anchors = source.vertices.leftCols(20);  // on the skin
  const std::vector<AnchorPair> pairs = part_pairs({source, source.vertices, target, parts}, anchors);
  ASSERT_EQ(pairs.size(), 80u);
  for (const AnchorPair& pair : pairs) {
    Eigen::Index vertex = 0;
    EXPECT_EQ((source.vertices.colwise() - pair.a).colwise().norm().minCoeff(&vertex), 0);
    // Areas grow unevenly under an affine map, so that moments are not quite mapped by it.
    EXPECT_LT((pair.b - target.vertices.col(vertex)).norm(), 0.25 * *pair.sigma) << pair.a.transpose();
    EXPECT_NEAR(*pair.sigma, 0.01 * diagonal(target.vertices), 1e-12);
  }
}

TEST(PartPairs, AreNoneOfPartsWithAnchorsAndOfPartsThatDoNotCorrespond) {
  const TriangleMesh source = limb(0), target = limb(1.5);
  const MatchedParts parts = match_parts(source, source.vertices, target);
  const MatchedModels models{source, source.vertices, target, parts};
  const Points all{{0, 0, 3}, {0, 0, 0}, {7, -7, 0}};
  EXPECT_TRUE(part_pairs(models, all).empty());
  EXPECT_EQ(part_pairs(models, all.leftCols(1)).size(), 80u);
  EXPECT_TRUE(part_pairs({source, source.vertices, target, {}}, all).empty());
}

}  // namespace
}  // namespace bespoke
