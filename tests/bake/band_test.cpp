#include "bespoke/bake/band.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bespoke/error.h"

namespace bespoke {
namespace {

Support two_balls() {
  Support support;
  support.frame.linear << 1.5, 0.2, 0, -0.1, 0.8, 0.3, 0, 0.1, 1.1;
  support.frame.offset << 0.3, -0.2, 0.1;
  support.clouds.push_back({Points::Zero(3, 1), 1.0});
  support.clouds.push_back({Vector3(2.5, 0, 0), 0.25});
  return support;
}

bool inside(const Support& support, const Vector3& x) {
  for (const BallCloud& cloud : support.clouds)
    for (Eigen::Index i = 0; i < cloud.centers.cols(); ++i)
      if ((support.frame * x - cloud.centers.col(i)).norm() <= cloud.radius) return true;
  return false;
}

TEST(BandLeaves, HoldEveryNodeOfTheSupport) {
  const Support support = two_balls();
  const Lattice lattice{Vector3(-0.123, 0.4, 0.2), 0.07};
  const std::vector<LeafCoordinates> leaves = band_leaves(support, lattice);
  EXPECT_TRUE(std::is_sorted(leaves.begin(), leaves.end()));
  EXPECT_EQ(std::adjacent_find(leaves.begin(), leaves.end()), leaves.end());
  int nodes_inside = 0;
  for (int i = -60; i <= 60; ++i)
    for (int j = -60; j <= 60; ++j)
      for (int k = -60; k <= 60; ++k) {
        if (!inside(support, lattice.origin + lattice.voxel_size * Vector3(i, j, k))) continue;
        ++nodes_inside;
        ASSERT_TRUE(
            std::binary_search(leaves.begin(), leaves.end(), LeafCoordinates{i >> 3, j >> 3, k >> 3}));
      }
  EXPECT_GT(nodes_inside, 1000);
  // Not much more than the support: all leaves are within one leaf of it.
  EXPECT_LT(leaves.size() * leaf_nodes, 8u * static_cast<std::size_t>(nodes_inside));
}

TEST(BandLeaves, AreCountedWithoutListing) {
  for (const double voxel_size : {0.5, 0.1, 0.03})
    EXPECT_EQ(count_band_leaves(two_balls(), {Vector3::Zero(), voxel_size}),
              band_leaves(two_balls(), {Vector3::Zero(), voxel_size}).size());
}

TEST(BandLeaves, OfNoBallAreNone) { EXPECT_TRUE(band_leaves(Support{}, {Vector3::Zero(), 1}).empty()); }

TEST(BandLeaves, RefuseWhatHasNoLattice) {
  Support support = two_balls();
  EXPECT_THROW(band_leaves(support, {Vector3::Zero(), 0}), InvalidInput);
  EXPECT_THROW(band_leaves(support, {Vector3::Zero(), std::nan("")}), InvalidInput);
  EXPECT_THROW(band_leaves(support, {Vector3::Zero(), 1e-10}), InvalidInput);
  support.frame.linear.col(0).setZero();
  EXPECT_THROW(band_leaves(support, {Vector3::Zero(), 0.1}), InvalidInput);
  support = two_balls();
  support.clouds[0].centers(0, 0) = std::nan("");
  EXPECT_THROW(band_leaves(support, {Vector3::Zero(), 0.1}), InvalidInput);
}

TEST(SupportBox, OfABallIsTight) {
  Support support;
  support.frame.linear = Vector3(2, 1, 1).asDiagonal();
  support.clouds.push_back({Vector3(2, 0, 0), 1.0});
  const Box box = bounding_box(support);
  EXPECT_NEAR((box.min() - Vector3(0.5, -1, -1)).norm(), 0, 1e-15);
  EXPECT_NEAR((box.max() - Vector3(1.5, 1, 1)).norm(), 0, 1e-15);
}

}  // namespace
}  // namespace bespoke
