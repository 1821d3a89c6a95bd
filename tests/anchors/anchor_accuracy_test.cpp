#include "bespoke/anchors/anchor_accuracy.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <utility>

#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::Each;
using ::testing::HasSubstr;

constexpr std::size_t pair_count = 60;

/// A sphere and an ellipsoid, with vertices of the one paired with their images.
struct Pair {
  TriangleMesh source = shapes::icosphere(4);
  TriangleMesh target = shapes::moved(source, {Vector3(1.1, 0.95, 1).asDiagonal(), Vector3(2, 0, 0)});
  Anchors anchors;

  Pair() {
    const auto stride = source.vertices.cols() / static_cast<Eigen::Index>(pair_count);
    for (std::size_t k = 0; k < pair_count; ++k) {
      const auto vertex = static_cast<Eigen::Index>(k) * stride;
      AnchorPair pair{"p", source.vertices.col(vertex), target.vertices.col(vertex)};
      pair.name += std::to_string(k);
      anchors.pairs.push_back(pair);
    }
  }
  double size() const { return diagonal(source.vertices); }
  EstimatedAnchors rate() const { return estimate_anchor_sigmas(anchors, source, target); }

  void disturb(double sigma) {
    std::mt19937 generator(7);
    std::normal_distribution<double> error(0, sigma);
    for (AnchorPair& pair : anchors.pairs)
      for (double& coordinate : pair.b) coordinate += error(generator);
  }
};

TEST(EstimateAnchorSigmas, TakesAnchorsOnBothSurfacesForExact) {
  const Pair pair;
  const EstimatedAnchors estimated = pair.rate();
  EXPECT_EQ(estimated.accuracy.estimated, pair_count);
  EXPECT_EQ(estimated.accuracy.sigma, 0);
  EXPECT_THAT(estimated.sigmas, Each(0.0));
  for (const AnchorPair& anchor : estimated.anchors.pairs) EXPECT_TRUE(is_exact(anchor));
  EXPECT_EQ(to_string(estimated.accuracy, pair.anchors), "");
}

TEST(EstimateAnchorSigmas, FindsTheDeviationOfTheErrors) {
  for (const double share : {0.003, 0.01}) {
    Pair pair;
    pair.disturb(share * pair.size());
    const EstimatedAnchors estimated = pair.rate();
    // The deviation of 60 squares' mean is 9 % of the root; three of them.
    EXPECT_NEAR(estimated.accuracy.sigma, share * pair.size(), 0.28 * share * pair.size());
    EXPECT_THAT(to_string(estimated.accuracy, pair.anchors), HasSubstr("60 anchors without an accuracy"));
    EXPECT_TRUE(estimated.accuracy.swapped.empty());
  }
}

TEST(OffTarget, AreAnchorsAtRandomInTheTargetsBoxUnlessTheyHaveAnAccuracy) {
  Pair pair;
  pair.disturb(0.03 * pair.size());
  EXPECT_EQ(off_target(pair.rate().accuracy, pair.target), "");
  const Box box = bounding_box(pair.target.vertices);
  const Points places = test::random_points(static_cast<Eigen::Index>(pair_count), 3);
  for (std::size_t k = 0; k < pair_count; ++k)
    pair.anchors.pairs[k].b =
        box.center() + 0.5 * box.sizes().cwiseProduct(places.col(static_cast<Eigen::Index>(k)));
  EXPECT_THAT(off_target(pair.rate().accuracy, pair.target), HasSubstr("as points at random would"));
  for (AnchorPair& anchor : pair.anchors.pairs) anchor.sigma = 1;
  EXPECT_EQ(off_target(pair.rate().accuracy, pair.target), "");
}

TEST(EstimateAnchorSigmas, LeavesAloneWhatHasAnAccuracyOrIsNoPointOfTheSurface) {
  Pair pair;
  pair.disturb(0.01 * pair.size());
  pair.anchors.pairs[0].sigma = 0;
  pair.anchors.pairs[1].sigma = 0.5;
  pair.anchors.pairs[2].weight = 3;
  pair.anchors.pairs[3].a *= 1.5;
  const EstimatedAnchors estimated = pair.rate();
  EXPECT_EQ(estimated.accuracy.estimated, pair_count - 4);
  EXPECT_EQ(estimated.anchors.pairs[0].sigma, 0.0);
  EXPECT_EQ(estimated.anchors.pairs[1].sigma, 0.5);
  EXPECT_EQ(estimated.anchors.pairs[2].sigma, std::nullopt);
  EXPECT_EQ(estimated.anchors.pairs[2].weight, 3);
  EXPECT_EQ(estimated.anchors.pairs[3].sigma, 0.0);
  EXPECT_EQ(estimated.anchors.pairs[4].sigma, estimated.accuracy.sigma);
}

TEST(EstimateAnchorSigmas, NamesAClickBesideTheTargetAndTrustsItNoFarther) {
  Pair pair;
  const double slip = 0.05 * pair.size();
  pair.anchors.pairs[8].b += slip * (pair.anchors.pairs[8].b - Vector3(2, 0, 0)).normalized();
  const EstimatedAnchors estimated = pair.rate();
  ASSERT_EQ(estimated.accuracy.outliers.size(), 1u);
  EXPECT_EQ(estimated.accuracy.outliers[0].index, 8u);
  EXPECT_EQ(estimated.accuracy.sigma, 0);
  EXPECT_NEAR(estimated.sigmas[8], slip, 0.1 * slip);  // an ellipsoid's normals are not quite its radii
  EXPECT_THAT(to_string(estimated.accuracy, pair.anchors), HasSubstr("\"p8\" lies"));
}

TEST(EstimateAnchorSigmas, NamesAPairLeftOutAsNothingElse) {
  Pair pair;
  pair.anchors.pairs[8].b += Vector3(0, pair.size(), 0);
  const EstimatedAnchors rest = without(pair.rate(), {{8, 1.5}});
  EXPECT_EQ(rest.anchors.pairs.size(), pair_count - 1);
  EXPECT_EQ(rest.sigmas[8], 1.5);
  EXPECT_TRUE(rest.accuracy.outliers.empty());
  const std::string text = to_string(rest.accuracy, pair.anchors);
  EXPECT_EQ(text.find("p8"), text.rfind("p8"));
}

TEST(EstimateAnchorSigmas, LeavesOutASwappedPairAndNamesIt) {
  Pair pair;
  std::swap(pair.anchors.pairs[3].b, pair.anchors.pairs[40].b);
  const EstimatedAnchors estimated = pair.rate();
  ASSERT_EQ(estimated.accuracy.swapped.size(), 1u);
  EXPECT_EQ(estimated.anchors.pairs.size(), pair_count - 2);
  ASSERT_EQ(estimated.sigmas.size(), pair_count);
  EXPECT_EQ(estimated.sigmas[3], (pair.anchors.pairs[3].b - pair.anchors.pairs[40].b).norm());
  EXPECT_THAT(to_string(estimated.accuracy, pair.anchors), HasSubstr("\"p3\" and \"p40\" look swapped"));
  for (AnchorPair& anchor : pair.anchors.pairs) anchor.sigma = 0;  // somebody stands by them
  EXPECT_TRUE(pair.rate().accuracy.swapped.empty());
}

}  // namespace
}  // namespace bespoke
