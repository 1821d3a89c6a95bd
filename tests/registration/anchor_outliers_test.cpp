#include "bespoke/registration/detail/anchor_outliers.h"

#include <gmock/gmock.h>

#include <numeric>
#include <vector>

#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A flat source, which is its own target, with pairs that say so.
struct TestedSquare {
  TriangleMesh square = shapes::square_grid(60);
  Points registered = square.vertices;
  Anchors given;
  double sigma = 0;  // of all pairs

  explicit TestedSquare(int pairs = 12) {
    for (int k = 0; k < pairs; ++k) {
      const Vector3 place = 0.1 * Vector3(1 + k % 4 * 2, 1 + k / 4 * 2, 0);
      given.pairs.push_back({"pair " + std::to_string(k), place, place});
    }
  }

  EstimatedAnchors estimated() const {
    EstimatedAnchors all;
    all.anchors = given;
    all.kept.resize(given.pairs.size());
    std::iota(all.kept.begin(), all.kept.end(), 0);
    all.sigmas.assign(given.pairs.size(), sigma);
    return all;
  }

  AnchorOutlierTest outlier_test() const { return {square, square, given, estimated()}; }
  std::vector<std::size_t> suspects(const AnchorAudit& audit = {}) const {
    return outlier_test().suspects(registered, audit);
  }

  /// Around the pair the source is placed so many times as long, and as short across.
  void stretch(std::size_t pair, double factor) {
    const Vector3 middle = given.pairs[pair].a;
    for (Eigen::Index i = 0; i < registered.cols(); ++i) {
      const Vector3 arm = square.vertices.col(i) - middle;
      if (arm.norm() < 0.08) registered.col(i) = middle + Vector3(factor * arm.x(), arm.y() / factor, 0);
    }
  }
};

AnchorAudit contradicting(std::size_t pair) {
  AnchorAudit audit;
  audit.suspicious.push_back({pair, "", 1, std::nullopt});
  return audit;
}

TEST(AnchorOutlierTest, SuspectsNoPairMatchedWithoutStrain) {
  EXPECT_THAT(TestedSquare().suspects(), IsEmpty());
}

TEST(AnchorOutlierTest, SuspectsPairsThatAreMatchedOnlyByAStrain) {
  TestedSquare scene;
  scene.stretch(7, 2);
  scene.stretch(3, 1.5);  // √2 ln 1.5 is .57, ln 2 is .69
  EXPECT_THAT(scene.suspects(), ElementsAre(7));
}

TEST(AnchorOutlierTest, SuspectsPairsThatTheOthersContradictByHalfOfIt) {
  TestedSquare scene;
  scene.stretch(3, 1.5);
  EXPECT_THAT(scene.suspects(contradicting(3)), ElementsAre(3));
  EXPECT_THAT(scene.suspects(contradicting(4)), IsEmpty());
}

TEST(AnchorOutlierTest, SuspectsPairsThatAreNotMatched) {
  TestedSquare scene;
  scene.given.pairs[2].b += Vector3(0, 0.039, 0) * std::sqrt(2);
  scene.given.pairs[5].b += Vector3(0, 0, 0.041) * std::sqrt(2);
  EXPECT_THAT(scene.suspects(), ElementsAre(5));
  const std::vector<RejectedAnchor> displaced =
      scene.outlier_test().displaced_pairs(scene.registered, {2, 5, 6});
  ASSERT_EQ(displaced.size(), 1u);
  EXPECT_EQ(displaced[0].index, 5u);
  EXPECT_NEAR(displaced[0].distance, 0.041 * std::sqrt(2), 1e-12);
}

TEST(AnchorOutlierTest, SuspectsNoPairWithinItsSigma) {
  TestedSquare scene;
  scene.given.pairs[2].b += Vector3(0, 0.079, 0);
  scene.given.pairs[5].b += Vector3(0, 0.081, 0);
  scene.sigma = 0.02;
  EXPECT_THAT(scene.suspects(), ElementsAre(5));
  EXPECT_EQ(scene.outlier_test().displaced_pairs(scene.registered, {2, 5}).size(), 1u);
  scene.sigma = 0.01;
  EXPECT_THAT(scene.suspects(), ElementsAre(2, 5));
}

TEST(AnchorOutlierTest, SuspectsAThirdAtMostAndNoneOfSix) {
  TestedSquare third;
  for (std::size_t pair = 0; pair < 4; ++pair) third.stretch(pair, 3);
  EXPECT_THAT(third.suspects(), ElementsAre(0, 1, 2, 3));
  TestedSquare seven(7), six(6);
  seven.stretch(1, 3);
  six.stretch(1, 3);
  EXPECT_THAT(seven.suspects(), ElementsAre(1));
  EXPECT_THAT(six.suspects(), IsEmpty());
}

TEST(AnchorOutlierTest, GoesByTheOtherPairsWhereMoreThanAThirdAreStrained) {
  TestedSquare half;
  for (std::size_t pair = 0; pair < 6; ++pair) half.stretch(pair, 3);
  EXPECT_THAT(half.suspects(), IsEmpty());
  EXPECT_THAT(half.suspects(contradicting(3)), ElementsAre(3));
  EXPECT_THAT(half.suspects(contradicting(9)), IsEmpty());
}

TEST(AnchorOutlierTest, SuspectsNoPairWithAGivenSigmaOrOffTheSource) {
  TestedSquare scene;
  for (const std::size_t pair : {0u, 1u, 2u, 3u}) scene.stretch(pair, 3);
  scene.given.pairs[0].sigma = 0;
  scene.given.pairs[1].weight = 1;
  scene.given.pairs[2].a.z() = 0.2;
  EXPECT_THAT(scene.suspects(), ElementsAre(3));
}

TEST(AnchorOutlierTest, KnowsNothingOfThePairsOfCurves) {
  TestedSquare scene;
  scene.stretch(7, 2);
  EstimatedAnchors estimated = scene.estimated();
  for (std::size_t k = 0; k < 40; ++k) {
    estimated.anchors.pairs.push_back(estimated.anchors.pairs[0]);
    estimated.kept.push_back(scene.given.pairs.size() + k);
  }
  EXPECT_THAT(
      AnchorOutlierTest(scene.square, scene.square, scene.given, estimated).suspects(scene.registered, {}),
      ElementsAre(7));
}

}  // namespace
}  // namespace bespoke
