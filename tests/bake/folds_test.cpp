#include "bespoke/bake/bake.h"

#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/certificate/certificate.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

// det ∇E = 1 + ∂u₀/∂x at its least is 1 − 1.71 · amplitude / radius on the axis: the first map keeps its
// orientation, the second does not.
TEST(BakeWithFolds, SaysWhatFoldsWhereTheMapDoes) {
  BakeOptions options;
  options.tolerance = 1e-2;
  options.error_points = 20000;
  const Bake right = bake(AnalyticMap({{Vector3::Zero(), 1.0, Vector3(0.5, 0, 0)}}), options);
  EXPECT_EQ(right.summary.folded_cells, 0u);
  EXPECT_TRUE(right.summary.tolerance_met);
  EXPECT_TRUE(certify(right.pyramid, {}).is_bijection());
  const Bake folded = bake(AnalyticMap({{Vector3::Zero(), 1.0, Vector3(0.6, 0, 0)}}), options);
  EXPECT_GT(folded.summary.folded_cells, 0u);
  EXPECT_FALSE(folded.certificate.is_bijection());
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

// Amplitudes as above: without a fold, and with few and many; then without finer leaves, and without a
// support.
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
