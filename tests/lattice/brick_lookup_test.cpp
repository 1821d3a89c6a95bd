#include "bespoke/lattice/detail/brick_lookup.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "bespoke/error.h"
#include "bespoke/lattice/pyramid_index.h"
#include "support/instruction_sets.h"
#include "support/random_pyramid.h"

namespace bespoke {
namespace {

constexpr double any_share = 100;
constexpr double float_rounding = 0x1p-24;
constexpr double double_rounding = 1e-14;

std::span<const double> span_of(const Points& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }
std::span<double> span_of(Points& x) { return {x.data(), static_cast<std::size_t>(x.size())}; }

Points values(const BrickAtlas& atlas, const Points& x) {
  Points u(3, x.cols());
  look_up(atlas, span_of(x), span_of(u));
  return u;
}

Points gradients(const BrickAtlas& atlas, const Points& x) {
  Points gradient(3, 3 * x.cols());
  look_up_gradient(atlas, span_of(x), span_of(gradient));
  return gradient;
}

// Values that are no multiples of anything.
Pyramid uneven_pyramid(int level_count, unsigned seed) {
  Pyramid pyramid = test::random_pyramid(level_count, seed);
  for (PyramidLevel& level : pyramid.levels)
    for (float& value : level.values) value = std::sin(100 * value);
  return pyramid;
}

TEST(BrickLookUp, IsThePyramidsSumRoundedToFloat) {
  for (int levels = 1; levels <= 5; ++levels) {
    const auto seed = static_cast<unsigned>(levels);
    const Pyramid pyramid = uneven_pyramid(levels, seed);
    const auto atlas = make_brick_atlas(pyramid, any_share);
    ASSERT_TRUE(atlas);
    const Points x = test::points_about_random_pyramid(60000, seed);
    const Points expected = look_up(pyramid, PyramidIndex(pyramid), x);
    EXPECT_GT((expected.array() != 0).count(), 10000);
    const double bound = (float_rounding + double_rounding) * largest_sum(pyramid);
    EXPECT_LE((values(*atlas, x) - expected).cwiseAbs().maxCoeff(), bound) << levels << " levels";
  }
}

// Sums of these values need no more bits than a float has.
TEST(BrickLookUp, IsThePyramidsSumWhereFloatsHoldIt) {
  for (int levels = 1; levels <= 4; ++levels) {
    const Pyramid pyramid = test::random_pyramid(levels, 4);
    const auto atlas = make_brick_atlas(pyramid, any_share);
    ASSERT_TRUE(atlas);
    const PyramidIndex index(pyramid);
    const Points x = test::points_about_random_pyramid(60000, 5);
    EXPECT_LE((values(*atlas, x) - look_up(pyramid, index, x)).cwiseAbs().maxCoeff(), double_rounding);
    const double steepest = largest_sum(pyramid) / pyramid.levels.back().voxel_size;
    EXPECT_LE((gradients(*atlas, x) - look_up_gradient(pyramid, index, x)).cwiseAbs().maxCoeff(),
              double_rounding * steepest);
  }
}

TEST(BrickLookUp, OfOneLevelHasTheBitsOfThePyramid) {
  const Pyramid pyramid = uneven_pyramid(1, 6);
  const auto atlas = make_brick_atlas(pyramid, any_share);
  const Points x = test::points_about_random_pyramid(60000, 7);
  EXPECT_EQ(values(*atlas, x), look_up(pyramid, PyramidIndex(pyramid), x));
}

TEST(BrickLookUp, OfGradientsIsThePyramidsRoundedToFloat) {
  const Pyramid pyramid = uneven_pyramid(4, 8);
  const auto atlas = make_brick_atlas(pyramid, any_share);
  const Points x = test::points_about_random_pyramid(60000, 9);
  const Points expected = look_up_gradient(pyramid, PyramidIndex(pyramid), x);
  const double bound =
      2 * (float_rounding + double_rounding) * largest_sum(pyramid) / pyramid.levels.back().voxel_size;
  EXPECT_LE((gradients(*atlas, x) - expected).cwiseAbs().maxCoeff(), bound);
}

// Faces of bricks lie at multiples of the octants of all levels; a hair to one side is another brick.
TEST(BrickLookUp, IsContinuousAcrossEveryFace) {
  const Pyramid pyramid = uneven_pyramid(4, 10);
  const auto atlas = make_brick_atlas(pyramid, any_share);
  Points at = test::points_about_random_pyramid(60000, 11);
  Points below = at;
  for (Eigen::Index i = 0; i < at.cols(); ++i) {
    const double octant = 4 * pyramid.levels[static_cast<std::size_t>(i % 4)].voxel_size;
    for (Eigen::Index axis = 0; axis <= i % 3; ++axis) {
      const double face =
          pyramid.origin[axis] + octant * std::round((at(axis, i) - pyramid.origin[axis]) / octant);
      at(axis, i) = face;
      below(axis, i) = std::nextafter(face, -1e3);
    }
  }
  const double bound = (2 * float_rounding + 10 * double_rounding) * largest_sum(pyramid);
  EXPECT_LE((values(*atlas, at) - values(*atlas, below)).cwiseAbs().maxCoeff(), bound);
}

TEST(BrickLookUp, IsZeroOutsideAndHasNoValueWhereAPointIsNotFinite) {
  const Pyramid pyramid = uneven_pyramid(3, 12);
  const auto atlas = make_brick_atlas(pyramid, any_share);
  Points outside(3, 7);
  // The box of level 0: leaves -3 … 2 of four units, and a cell around them.
  outside << 1e300, -1e300, 0, 0, 12.26, -12.26, 0, 0, 0, 2e9, 0, 0, 0, 11.1, 0, 0, 0, -1e10, 2, 2, 2;
  EXPECT_TRUE(values(*atlas, outside).isZero(0));
  EXPECT_TRUE(gradients(*atlas, outside).isZero(0));
  const double infinity = std::numeric_limits<double>::infinity();
  Points undefined(3, 4);
  undefined << std::nan(""), 0, infinity, 1, 0, std::nan(""), 0, 1, 0, 0, 0, -infinity;
  EXPECT_TRUE(values(*atlas, undefined).array().isNaN().all());
  EXPECT_TRUE(gradients(*atlas, undefined).isZero(0));
}

TEST(BrickLookUp, OfManyPointsIsThatOfEachAndMayReplaceThem) {
  const auto atlas = make_brick_atlas(uneven_pyramid(3, 13), any_share);
  const Points x = test::points_about_random_pyramid(5000, 14);
  const Points together = values(*atlas, x), gradient = gradients(*atlas, x);
  for (Eigen::Index i = 0; i < x.cols(); i += 7) {
    EXPECT_EQ(values(*atlas, x.col(i)), together.col(i));
    EXPECT_EQ(gradients(*atlas, x.col(i)), gradient.middleCols(3 * i, 3));
  }
  Points in_place = x;
  look_up(*atlas, span_of(in_place), span_of(in_place));
  EXPECT_EQ(in_place, together);
}

std::vector<double> all_numbers(const BrickAtlas& atlas, const Points& x) {
  const Points u = values(atlas, x), gradient = gradients(atlas, x);
  std::vector<double> numbers(u.data(), u.data() + u.size());
  numbers.insert(numbers.end(), gradient.data(), gradient.data() + gradient.size());
  return numbers;
}

TEST(BrickLookUp, HasTheSameBitsWithEveryInstructionSet) {
  const auto atlas = make_brick_atlas(uneven_pyramid(4, 15), any_share);
  const Points x = test::points_about_random_pyramid(30001, 16);
  test::expect_same_bits_with_every_instruction_set([&] { return all_numbers(*atlas, x); });
}

TEST(BrickLookUp, HasTheSameBitsAtAnyNumberOfThreads) {
  const Pyramid pyramid = uneven_pyramid(4, 17);
  const Points x = test::points_about_random_pyramid(30001, 18);
  std::vector<std::vector<double>> found;
  for (const std::size_t threads : {1u, 2u, 5u}) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
    found.push_back(all_numbers(*make_brick_atlas(pyramid, any_share), x));
  }
  EXPECT_EQ(found[0], found[1]);
  EXPECT_EQ(found[0], found[2]);
}

TEST(BrickLookUp, RefusesSizesThatDoNotAgree) {
  const auto atlas = make_brick_atlas(uneven_pyramid(1, 19), any_share);
  std::vector<double> x(6), u(3), part(7);
  EXPECT_THROW(look_up(*atlas, x, u), InvalidInput);
  EXPECT_THROW(look_up(*atlas, part, part), InvalidInput);
  EXPECT_THROW(look_up_gradient(*atlas, u, x), InvalidInput);
}

}  // namespace
}  // namespace bespoke
