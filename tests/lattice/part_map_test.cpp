#include "bespoke/lattice/part_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/lattice/atlas_map.h"
#include "bespoke/lattice/baked_map.h"
#include "support/elastic_map_contract.h"
#include "support/pyramid_part_of.h"
#include "support/random_pyramid.h"

namespace bespoke {
namespace {

// Values that are no multiples of anything.
Pyramid uneven(Pyramid pyramid) {
  for (PyramidLevel& level : pyramid.levels)
    for (std::size_t i = 0; i < level.values.size(); ++i)
      level.values[i] = static_cast<float>(std::sin(0.37 * static_cast<double>(i)));
  return pyramid;
}

// Two full levels about the origin, and a third that is ragged, so that an atlas is made of bricks of both
// sizes at places of both signs.
Pyramid with_atlas() {
  Pyramid pyramid = test::random_pyramid(3, 1);
  for (int level = 0; level < 2; ++level) {
    std::vector<LeafCoordinates>& leaves = pyramid.levels[static_cast<std::size_t>(level)].leaves;
    leaves.clear();
    const int end = 2 << level;
    for (int i = -end; i < end; ++i)
      for (int j = -end; j < end; ++j)
        for (int k = -end; k < end; ++k) leaves.push_back({i, j, k});
  }
  std::mt19937 engine(2);
  std::bernoulli_distribution chosen(0.4);
  std::vector<LeafCoordinates> finest;
  for (const LeafCoordinates& leaf : pyramid.levels[1].leaves)
    for (int octant = 0; octant < 8; ++octant)
      if (chosen(engine)) finest.push_back(child_of(leaf, octant));
  pyramid.levels[2].leaves = unique_leaves(finest);
  for (PyramidLevel& level : pyramid.levels) level.values.assign(leaf_floats * level.leaves.size(), 0.0f);
  return uneven(pyramid);
}

void expect_bits_of_the_whole(const Pyramid& whole, unsigned seed) {
  std::mt19937 engine(seed);
  const AffineMap affine = test::some_affine();
  const auto loaded = loaded_map(affine, whole);
  Eigen::Index moved = 0;
  for (int n = 0; n < 40; ++n) {
    const Box box = test::random_box(engine, n % 2 == 0 ? 0.5 : 6);
    const PartMap part(affine, test::part_of(whole, box));
    const Points x = test::points_in(box, 1000, engine);
    const Points u = loaded->displacement(x);
    ASSERT_EQ(part.displacement(x), u) << "box " << n;
    ASSERT_EQ(part.displacement_gradient(x), loaded->displacement_gradient(x)) << "box " << n;
    moved += (u.array() != 0).count();
  }
  EXPECT_GT(moved, 5000);
}

TEST(PartMap, HasTheBitsOfTheAtlasOfTheWhole) {
  const Pyramid whole = with_atlas();
  ASSERT_NE(dynamic_cast<const AtlasMap*>(loaded_map({}, whole).get()), nullptr);
  expect_bits_of_the_whole(whole, 3);
}

TEST(PartMap, HasTheBitsOfTheLevelsWhereTheWholeHasNoAtlas) {
  const Pyramid whole = uneven(test::random_pyramid(4, 4));
  ASSERT_NE(dynamic_cast<const BakedMap*>(loaded_map({}, whole).get()), nullptr);
  expect_bits_of_the_whole(whole, 5);
}

// Never another value than the whole's, wherever it is queried.
void expect_the_whole_or_a_refusal(const Pyramid& whole) {
  const auto loaded = loaded_map({}, whole);
  const PartMap part({}, test::part_of(whole, {Vector3(-1, -2, 1), Vector3(0, 0, 2)}));
  const Points x = test::points_about_random_pyramid(20000, 6);
  int refused = 0, returned = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Points point = x.col(i);
    try {
      ASSERT_EQ(part.displacement(point), loaded->displacement(point));
      ASSERT_EQ(part.displacement_gradient(point), loaded->displacement_gradient(point));
      ++returned;
    } catch (const OutsidePart&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
  EXPECT_GT(returned, 100);
  EXPECT_THROW(part.displacement(x), OutsidePart);
}

TEST(PartMap, ThrowsWhereItWasNotRead) {
  expect_the_whole_or_a_refusal(with_atlas());
  expect_the_whole_or_a_refusal(uneven(test::random_pyramid(4, 7)));
}

TEST(PartMap, NamesThePointThatAsksForTooMuch) {
  const PartMap part({}, test::part_of(with_atlas(), {Vector3(-1, -2, 1), Vector3(0, 0, 2)}));
  Points x(3, 2);
  x << -0.5, 7.5, -1, 6, 1.5, 9;
  try {
    part.displacement(x);
    FAIL();
  } catch (const OutsidePart& error) {
    EXPECT_NE(std::string(error.what()).find("point 1 (7.5"), std::string::npos) << error.what();
  }
}

TEST(PartMap, HasTheSupportOfTheWhole) {
  const Pyramid whole = with_atlas();
  const PartMap part({}, test::part_of(whole, {Vector3::Zero(), Vector3::Ones()}));
  const Support expected = support_of(whole), found = part.support();
  ASSERT_EQ(found.clouds.size(), expected.clouds.size());
  for (std::size_t level = 0; level < expected.clouds.size(); ++level)
    EXPECT_EQ(found.clouds[level].centers, expected.clouds[level].centers);
}

TEST(PartMap, OfAPyramidWithoutLevelsIsAffine) {
  EXPECT_TRUE(PartMap({}, {}).displacement(Points::Random(3, 10)).isZero(0));
}

}  // namespace
}  // namespace bespoke
