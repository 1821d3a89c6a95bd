#include "bespoke/lattice/brick_atlas.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/random_pyramid.h"

namespace bespoke {
namespace {

std::size_t value_bytes(const Pyramid& pyramid) { return sizeof(float) * leaf_floats * pyramid.leaf_count(); }

Pyramid pyramid_of(const std::vector<std::vector<LeafCoordinates>>& levels, float value) {
  Pyramid pyramid;
  double voxel_size = 1;
  for (const auto& leaves : levels) {
    pyramid.levels.push_back({voxel_size, leaves, std::vector<float>(leaf_floats * leaves.size(), value)});
    voxel_size /= 2;
  }
  return pyramid;
}

std::vector<LeafCoordinates> full_cube(int edge) {
  std::vector<LeafCoordinates> leaves;
  for (int i = 0; i < edge; ++i)
    for (int j = 0; j < edge; ++j)
      for (int k = 0; k < edge; ++k) leaves.push_back({i, j, k});
  return leaves;
}

TEST(BrickAtlas, TakesNoMoreThanItsShareOrIsNotMade) {
  int made = 0, refused = 0;
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const double share : {2.0, 3.0, 4.0, 5.0, 6.0}) {
      const Pyramid pyramid = test::random_pyramid(3, seed);
      const auto atlas = make_brick_atlas(pyramid, share);
      if (atlas) {
        EXPECT_LE(static_cast<double>(atlas->byte_count()),
                  share * static_cast<double>(value_bytes(pyramid)));
      }
      ++(atlas ? made : refused);
    }
  EXPECT_GT(made, 0);
  EXPECT_GT(refused, 0);
}

// Every leaf has at most a brick of its own and 19 octants in its lower neighbours; levels that others cover
// altogether have none.
TEST(BrickAtlas, OfLevelsThatCoverOneAnotherHoldsTheLast) {
  const Pyramid one = pyramid_of({full_cube(8)}, 1),
                three = pyramid_of({full_cube(2), full_cube(4), full_cube(8)}, 1);
  const auto atlas_of_one = make_brick_atlas(one), atlas_of_three = make_brick_atlas(three);
  ASSERT_TRUE(atlas_of_one && atlas_of_three);
  // The coarser levels reach one cell farther down, where they have a rim of their own.
  EXPECT_LT(atlas_of_three->value_count, atlas_of_one->value_count * 5 / 4);
  EXPECT_LT(static_cast<double>(atlas_of_one->byte_count()), 2.2 * static_cast<double>(value_bytes(one)));
}

TEST(BrickAtlas, IsNotMadeOfNothingNorOfSumsThatNoFloatHolds) {
  EXPECT_FALSE(make_brick_atlas({}, 100));
  const Pyramid fits = pyramid_of({full_cube(2), full_cube(4)}, 1e38f);
  EXPECT_TRUE(make_brick_atlas(fits, 100));
  const Pyramid overflows = pyramid_of({full_cube(2), full_cube(4)}, 3e38f);
  EXPECT_FALSE(make_brick_atlas(overflows, 100));
}

TEST(BrickAtlas, IsNotMadeWherePlacesExceedAnInt) {
  const std::vector<LeafCoordinates> near = {{0, 0, 0}};
  const std::vector<LeafCoordinates> far = {{0, 0, 0}, {1 << 26, 0, 0}};
  EXPECT_TRUE(make_brick_atlas(pyramid_of({far, near}, 1), 100));
  EXPECT_FALSE(make_brick_atlas(pyramid_of({far, near, near, near, near, near}, 1), 100));
  EXPECT_TRUE(make_brick_atlas(pyramid_of({near, near, near, near, near, near}, 1), 100));
}

}  // namespace
}  // namespace bespoke
