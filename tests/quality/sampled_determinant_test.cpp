#include "bespoke/quality/sampled_determinant.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/elastic_chain.h"

namespace bespoke {
namespace {

constexpr double slope = 0.4;

// u = (f, 0, 0) with f a tent along x, so that det = 1 + ∂f/∂x is 1 − slope behind its ridge.
Pyramid tent() {
  Pyramid pyramid;
  PyramidLevel level{0.5, {{0, 0, 0}}, std::vector<float>(leaf_floats, 0.F)};
  for (int i = 0; i < 8; ++i)
    for (int rest = 0; rest < 64; ++rest)
      level.values[static_cast<std::size_t>(3 * (64 * i + rest))] =
          static_cast<float>(slope * level.voxel_size * std::min(i, 8 - i));
  pyramid.levels.push_back(level);
  return pyramid;
}

TEST(SampledDeterminant, IsThatOfTheTightestCells) {
  const BakedMap map({}, tent());
  EXPECT_NEAR(sampled_min_determinant(map, {&map.pyramid()}, 10'000), 1 - slope, 1e-6);
}

TEST(SampledDeterminant, OfAMapWithoutLeavesIsTheAffineParts) {
  AffineMap affine;
  affine.linear *= 0.5;
  EXPECT_DOUBLE_EQ(sampled_min_determinant(BakedMap(affine, {}), {}), 0.125);
}

TEST(SampledDeterminant, OfAChainIsAboveTheProductOfItsStepsBounds) {
  const auto step = std::make_shared<const BakedMap>(AffineMap{}, tent());
  const double together =
      sampled_min_determinant(ElasticChain({step, step}), {&step->pyramid(), &step->pyramid()}, 20'000);
  EXPECT_GE(together, std::pow(1 - slope, 2) - 1e-6);
  EXPECT_LT(together, 1 - slope - 0.1);  // the ridge moves less than the flank is long
}

TEST(SampledDeterminant, OfAChainSeesWhatOnlyItsLaterStepsMove) {
  Pyramid apart = tent();
  apart.origin.x() = 100;
  const auto first = std::make_shared<const BakedMap>(AffineMap{}, Pyramid{});
  const auto later = std::make_shared<const BakedMap>(AffineMap{}, apart);
  EXPECT_NEAR(
      sampled_min_determinant(ElasticChain({first, later}), {&first->pyramid(), &later->pyramid()}, 10'000),
      1 - slope, 1e-6);
}

}  // namespace
}  // namespace bespoke
