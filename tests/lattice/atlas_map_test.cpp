#include "bespoke/lattice/atlas_map.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "support/elastic_map_contract.h"
#include "support/random_pyramid.h"

namespace bespoke {
namespace {

// A cube of leaves at two levels, of which an atlas is made.
Pyramid full_pyramid() {
  Pyramid pyramid = test::random_pyramid(2, 1);
  for (std::size_t level = 0; level < 2; ++level) {
    std::vector<LeafCoordinates> leaves;
    for (int i = 0; i < 4 << level; ++i)
      for (int j = 0; j < 4 << level; ++j)
        for (int k = 0; k < 4 << level; ++k) leaves.push_back({i, j, k});
    pyramid.levels[level].leaves = leaves;
    pyramid.levels[level].values.resize(leaf_floats * leaves.size());
    for (std::size_t i = 0; i < pyramid.levels[level].values.size(); ++i)
      pyramid.levels[level].values[i] = static_cast<float>(std::sin(0.01 * static_cast<double>(i)));
  }
  return pyramid;
}

TEST(AtlasMap, IsTheBakedMapRoundedToFloat) {
  const AffineMap affine = test::some_affine();
  const Pyramid pyramid = full_pyramid();
  const BakedMap baked(affine, pyramid);
  const auto loaded = loaded_map(affine, pyramid);
  ASSERT_NE(dynamic_cast<const AtlasMap*>(loaded.get()), nullptr);
  const Points x = test::points_about_random_pyramid(50000, 2);
  const double bound = (0x1p-24 + 1e-14) * largest_sum(pyramid);
  EXPECT_LE(((*loaded)(x)-baked(x)).cwiseAbs().maxCoeff(), bound);
  EXPECT_GT((loaded->displacement(x).array() != 0).count(), 1000);
  EXPECT_LE((loaded->displacement_gradient(x) - baked.displacement_gradient(x)).cwiseAbs().maxCoeff(),
            2 * bound / pyramid.levels.back().voxel_size);
  test::expect_support_holds(*loaded, x);
}

TEST(AtlasMap, GivesWayToTheBakedMapWhereItWouldTakeTooMuchMemory) {
  const Pyramid pyramid = test::random_pyramid(4, 3);
  const auto loaded = loaded_map({}, pyramid);
  ASSERT_NE(dynamic_cast<const BakedMap*>(loaded.get()), nullptr);
  const Points x = test::points_about_random_pyramid(1000, 4);
  EXPECT_EQ(loaded->displacement(x), BakedMap({}, pyramid).displacement(x));
}

TEST(AtlasMap, OfAPyramidWithoutLevelsIsAffine) {
  EXPECT_TRUE(loaded_map({}, {})->displacement(Points::Random(3, 10)).isZero(0));
}

TEST(AtlasMap, IsNotMadeOfAPyramidThatIsNotValid) {
  Pyramid pyramid = test::random_pyramid(2, 5);
  pyramid.levels[1].values.pop_back();
  EXPECT_THROW(loaded_map({}, pyramid), InvalidInput);
}

}  // namespace
}  // namespace bespoke
