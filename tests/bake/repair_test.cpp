#include "bespoke/bake/detail/repair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/bake/bake.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

// A gentle field with one node pushed through its neighbours.
Pyramid with_one_fold() {
  Pyramid pyramid;
  pyramid.levels.push_back({1, {{0, 0, 0}}, {}});
  for (int n = 0; n < leaf_nodes; ++n)
    for (int c = 0; c < 3; ++c)
      pyramid.levels[0].values.push_back(0.01f * static_cast<float>((n * (c + 3)) % 7));
  pyramid.levels[0].values[3 * ((3 * 8 + 4) * 8 + 3)] = 1.5f;
  return pyramid;
}

std::vector<FoldedCell> folds_of(const Pyramid& pyramid, const AffineMap& affine = {}) {
  return certify_listing_all(pyramid, affine).places;
}

TEST(RepairFolds, MendsAFoldAndLeavesFarNodesAlone) {
  const Pyramid folded = with_one_fold();
  ASSERT_GT(certify(folded, {}).folded, 0u);
  Pyramid repaired = folded;
  const RepairSummary summary = repair_folds(repaired, {}, folds_of(folded));
  EXPECT_EQ(summary.folded, 0u);
  EXPECT_EQ(summary.cells, certify(folded, {}).folded);
  EXPECT_TRUE(certify(repaired, {}).is_bijection());
  double largest = 0;
  for (int n = 0; n < leaf_nodes; ++n) {
    Vector3 change;
    for (int c = 0; c < 3; ++c)
      change[c] = repaired.levels[0].values[static_cast<std::size_t>(3 * n + c)] -
                  folded.levels[0].values[static_cast<std::size_t>(3 * n + c)];
    largest = std::max(largest, change.norm());
    const Vector3 place(n / 64, n / 8 % 8, n % 8);
    if ((place - Vector3(3, 4, 3)).cwiseAbs().maxCoeff() > 3) {
      EXPECT_EQ(change, Vector3::Zero()) << place.transpose();
    }
  }
  EXPECT_NEAR(summary.largest_change, largest, 1e-6);
  EXPECT_GT(largest, 0.5);
}

TEST(RepairFolds, LeavesACertifiedPyramidAlone) {
  Pyramid pyramid;
  pyramid.levels.push_back({1, {{0, 0, 0}}, std::vector<float>(3 * leaf_nodes, 0.1f)});
  const std::vector<float> before = pyramid.levels[0].values;
  const RepairSummary summary = repair_folds(pyramid, {}, folds_of(pyramid));
  EXPECT_EQ(summary.cells, 0u);
  EXPECT_EQ(summary.largest_change, 0);
  EXPECT_EQ(pyramid.levels[0].values, before);
}

TEST(RepairFolds, CannotMendTheAffinePart) {
  AffineMap mirrored;
  mirrored.linear = Vector3(1, 1, -1).asDiagonal();
  Pyramid pyramid = with_one_fold();
  EXPECT_GT(repair_folds(pyramid, mirrored, folds_of(pyramid, mirrored)).folded, 0u);
}

// det ∇E = 1 + ∂u₀/∂x at its least is 1 − 1.71 · amplitude / radius on the axis: the first map keeps its
// orientation, the second does not.
TEST(BakeWithFolds, IsRepairedAtACost) {
  BakeOptions options;
  options.tolerance = 1e-2;
  options.error_points = 20000;
  const Bake right = bake(AnalyticMap({{Vector3::Zero(), 1.0, Vector3(0.5, 0, 0)}}), options);
  EXPECT_EQ(right.summary.repaired_cells, 0u);
  EXPECT_EQ(right.summary.folded_cells, 0u);
  EXPECT_TRUE(right.summary.tolerance_met);
  EXPECT_TRUE(certify(right.pyramid, {}).is_bijection());
  const Bake folded = bake(AnalyticMap({{Vector3::Zero(), 1.0, Vector3(0.6, 0, 0)}}), options);
  EXPECT_GT(folded.summary.repaired_cells, 0u);
  EXPECT_GT(folded.summary.repair_cost, 0);
  EXPECT_EQ(folded.summary.folded_cells, 0u);
  EXPECT_TRUE(certify(folded.pyramid, {}).is_bijection());
}

void expect_certificate_of_the_pyramid(const Bake& baked, const AffineMap& affine) {
  const Certificate found = baked.certificate, expected = certify(baked.pyramid, affine);
  EXPECT_EQ(found.certified, expected.certified);
  EXPECT_EQ(found.folded, expected.folded);
  EXPECT_EQ(found.undecided, expected.undecided);
  EXPECT_EQ(found.min_determinant, expected.min_determinant);
  EXPECT_EQ(found.affine_determinant, expected.affine_determinant);
  EXPECT_EQ(found.places.size(), expected.places.size());
  EXPECT_EQ(baked.summary.folded_cells, expected.folded + expected.undecided);
}

// Amplitudes as above: without a fold, with one that is repaired, and with more than can be; then without
// finer leaves, and without a support.
TEST(BakeWithFolds, IsCertifiedAsItIsReturned) {
  BakeOptions options;
  options.tolerance = 1e-2;
  options.error_points = 2000;
  for (const double amplitude : {0.5, 0.6, 3.0}) {
    SCOPED_TRACE(amplitude);
    const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(amplitude, 0, 0)}});
    expect_certificate_of_the_pyramid(bake(map, options), {});
    BakeOptions uniform = options;
    uniform.voxel_size = 0.05;
    expect_certificate_of_the_pyramid(bake(map, uniform), {});
  }
  AffineMap affine;
  affine.linear *= 2;
  expect_certificate_of_the_pyramid(bake(AnalyticMap({}, affine), options), affine);
}

}  // namespace
}  // namespace bespoke
