#include "bespoke/pipeline/anchor_judge.h"

#include <gmock/gmock.h>

#include <numeric>
#include <vector>

#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// A flat source, which is its own target, with pairs that say so.
struct JudgedSquare {
  TriangleMesh square = shapes::square_grid(60);
  Points laid = square.vertices;
  Anchors given;
  double sigma = 0;  // of all pairs

  explicit JudgedSquare(int pairs = 12) {
    for (int k = 0; k < pairs; ++k) {
      const Vector3 place = 0.1 * Vector3(1 + k % 4 * 2, 1 + k / 4 * 2, 0);
      given.pairs.push_back({"pair " + std::to_string(k), place, place});
    }
  }

  RatedAnchors rated() const {
    RatedAnchors all;
    all.anchors = given;
    all.kept.resize(given.pairs.size());
    std::iota(all.kept.begin(), all.kept.end(), 0);
    all.sigmas.assign(given.pairs.size(), sigma);
    return all;
  }

  AnchorJudge judge() const { return {square, square, given, rated()}; }
  std::vector<std::size_t> doubted(const AnchorAudit& audit = {}) const {
    return judge().doubted(laid, audit);
  }

  /// Around the pair the source is laid so many times as long, and as short across.
  void stretch(std::size_t pair, double factor) {
    const Vector3 middle = given.pairs[pair].a;
    for (Eigen::Index i = 0; i < laid.cols(); ++i) {
      const Vector3 arm = square.vertices.col(i) - middle;
      if (arm.norm() < 0.08) laid.col(i) = middle + Vector3(factor * arm.x(), arm.y() / factor, 0);
    }
  }
};

AnchorAudit contradicting(std::size_t pair) {
  AnchorAudit audit;
  audit.suspicious.push_back({pair, "", 1, std::nullopt});
  return audit;
}

TEST(AnchorJudge, DoubtsNoPairThatTheSourceMeetsAtEase) { EXPECT_THAT(JudgedSquare().doubted(), IsEmpty()); }

TEST(AnchorJudge, DoubtsPairsThatAreMetOnlyByAStrain) {
  JudgedSquare scene;
  scene.stretch(7, 2);
  scene.stretch(3, 1.5);  // √2 ln 1.5 is .57, ln 2 is .69
  EXPECT_THAT(scene.doubted(), ElementsAre(7));
}

TEST(AnchorJudge, DoubtsPairsThatTheOthersContradictByHalfOfIt) {
  JudgedSquare scene;
  scene.stretch(3, 1.5);
  EXPECT_THAT(scene.doubted(contradicting(3)), ElementsAre(3));
  EXPECT_THAT(scene.doubted(contradicting(4)), IsEmpty());
}

TEST(AnchorJudge, DoubtsPairsThatAreNotMet) {
  JudgedSquare scene;
  scene.given.pairs[2].b += Vector3(0, 0.039, 0) * std::sqrt(2);
  scene.given.pairs[5].b += Vector3(0, 0, 0.041) * std::sqrt(2);
  EXPECT_THAT(scene.doubted(), ElementsAre(5));
  const std::vector<LeftOutAnchor> elsewhere = scene.judge().put_elsewhere(scene.laid, {2, 5, 6});
  ASSERT_EQ(elsewhere.size(), 1u);
  EXPECT_EQ(elsewhere[0].index, 5u);
  EXPECT_NEAR(elsewhere[0].distance, 0.041 * std::sqrt(2), 1e-12);
}

TEST(AnchorJudge, DoubtsNoPairThatIsNotMetAsItsSigmaSays) {
  JudgedSquare scene;
  scene.given.pairs[2].b += Vector3(0, 0.079, 0);
  scene.given.pairs[5].b += Vector3(0, 0.081, 0);
  scene.sigma = 0.02;
  EXPECT_THAT(scene.doubted(), ElementsAre(5));
  EXPECT_EQ(scene.judge().put_elsewhere(scene.laid, {2, 5}).size(), 1u);
  scene.sigma = 0.01;
  EXPECT_THAT(scene.doubted(), ElementsAre(2, 5));
}

TEST(AnchorJudge, DoubtsAThirdAtMostAndNoneOfSix) {
  JudgedSquare third;
  for (std::size_t pair = 0; pair < 4; ++pair) third.stretch(pair, 3);
  EXPECT_THAT(third.doubted(), ElementsAre(0, 1, 2, 3));
  JudgedSquare seven(7), six(6);
  seven.stretch(1, 3);
  six.stretch(1, 3);
  EXPECT_THAT(seven.doubted(), ElementsAre(1));
  EXPECT_THAT(six.doubted(), IsEmpty());
}

TEST(AnchorJudge, GoesByTheOtherPairsWhereMoreThanAThirdAreStrained) {
  JudgedSquare half;
  for (std::size_t pair = 0; pair < 6; ++pair) half.stretch(pair, 3);
  EXPECT_THAT(half.doubted(), IsEmpty());
  EXPECT_THAT(half.doubted(contradicting(3)), ElementsAre(3));
  EXPECT_THAT(half.doubted(contradicting(9)), IsEmpty());
}

TEST(AnchorJudge, DoubtsNoPairThatSomebodyStandsByOrThatIsNoPlaceOfTheSource) {
  JudgedSquare scene;
  for (const std::size_t pair : {0u, 1u, 2u, 3u}) scene.stretch(pair, 3);
  scene.given.pairs[0].sigma = 0;
  scene.given.pairs[1].weight = 1;
  scene.given.pairs[2].a.z() = 0.2;
  EXPECT_THAT(scene.doubted(), ElementsAre(3));
}

TEST(AnchorJudge, KnowsNothingOfThePairsOfCurves) {
  JudgedSquare scene;
  scene.stretch(7, 2);
  RatedAnchors rated = scene.rated();
  for (std::size_t k = 0; k < 40; ++k) {
    rated.anchors.pairs.push_back(rated.anchors.pairs[0]);
    rated.kept.push_back(scene.given.pairs.size() + k);
  }
  EXPECT_THAT(AnchorJudge(scene.square, scene.square, scene.given, rated).doubted(scene.laid, {}),
              ElementsAre(7));
}

}  // namespace
}  // namespace bespoke
