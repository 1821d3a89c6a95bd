#include "bespoke/anchors/detail/biharmonic_warp.h"

#include <gtest/gtest.h>

#include "support/random_points.h"

namespace bespoke {
namespace {

const Points warped_sources = test::random_points(15, 1), warped_targets = test::random_points(15, 2);

TEST(BiharmonicWarp, BendsNothingUnderAnAffineMap) {
  const Points image = (test::random_rotation(3) * 1.3 * warped_sources).colwise() + Vector3(2, 0, 1);
  const BiharmonicWarp warp(warped_sources, image);
  EXPECT_NEAR(warp.energy(), 0, 1e-9);
  EXPECT_LT((warp(Vector3(5, 6, 7)) - (test::random_rotation(3) * 1.3 * Vector3(5, 6, 7) + Vector3(2, 0, 1)))
                .norm(),
            1e-9);
}

TEST(BiharmonicWarp, PredictsAPairByTheOthers) {
  const BiharmonicWarp warp(warped_sources, warped_targets);
  const BiharmonicWarp others(warped_sources.leftCols(14), warped_targets.leftCols(14));
  // The smoothing is relative to the sources' box, which the last of them does not span.
  EXPECT_NEAR(warp.left_out(14), (others(warped_sources.col(14)) - warped_targets.col(14)).norm(), 1e-2);
}

TEST(BiharmonicWarp, KnowsTheEnergyWithoutAPair) {
  Points sources = warped_sources;
  sources.col(14) = sources.leftCols(14).rowwise().mean();  // the smoothing is relative to the sources' box
  const double without = BiharmonicWarp(sources.leftCols(14), warped_targets.leftCols(14)).energy();
  EXPECT_NEAR(BiharmonicWarp(sources, warped_targets).energy_without(14), without, 1e-9 * without);
}

TEST(BiharmonicWarp, KnowsTheEnergyOfInterchangedTargets) {
  const BiharmonicWarp warp(warped_sources, warped_targets);
  EXPECT_GT(warp.energy(), 0);
  Points changed = warped_targets;
  changed.col(3).swap(changed.col(9));
  const double expected = BiharmonicWarp(warped_sources, changed).energy();
  EXPECT_NEAR(warp.energy_interchanged(3, 9), expected, 1e-9 * expected);
}

}  // namespace
}  // namespace bespoke
