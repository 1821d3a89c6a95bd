#include "bespoke/surface_fit/graph/anchor_posterior.h"

#include <gmock/gmock.h>

#include <vector>

namespace bespoke {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

/// Anchors on a surface of unit area and diagonal, all tested, off by 2 % of it where the others would put
/// them.
struct TestedScene {
  TestedAnchors anchors;
  LeftOutAnchors left_out;

  explicit TestedScene(int count = 12) {
    anchors.tested.assign(static_cast<std::size_t>(count), 1);
    anchors.sigmas = Eigen::VectorXd::Zero(count);
    anchors.area = 1;
    left_out = {Eigen::VectorXd::Constant(count, 0.02), Eigen::VectorXd::Ones(count)};
  }

  std::vector<Eigen::Index> outliers() const {
    AnchorPosterior posterior(anchors, {});
    posterior.update(left_out);
    return posterior.outliers();
  }
};

TEST(AnchorPosterior, HasNoOutlierAmongEqualDistances) { EXPECT_THAT(TestedScene().outliers(), IsEmpty()); }

TEST(AnchorPosterior, TellsWhatLiesManyDeviationsOff) {
  TestedScene scene;
  scene.left_out.distances[3] = 0.2;
  scene.left_out.distances[7] = 0.03;
  EXPECT_THAT(scene.outliers(), ElementsAre(3));
}

TEST(AnchorPosterior, ExpectsMoreOfWhatTheOthersHoldLess) {
  TestedScene scene;
  scene.left_out.distances[3] = 0.2;
  scene.left_out.compliances[3] = 100;
  EXPECT_THAT(scene.outliers(), IsEmpty());
}

TEST(AnchorPosterior, IsOfAnyUnitOfTheCompliances) {
  TestedScene scene;
  scene.left_out.distances[3] = 0.2;
  scene.left_out.compliances *= 1e6;
  EXPECT_THAT(scene.outliers(), ElementsAre(3));
}

TEST(AnchorPosterior, AllowsForGivenAccuracies) {
  TestedScene scene;
  scene.left_out.distances[3] = 0.2;
  scene.anchors.sigmas[3] = 0.1;
  EXPECT_THAT(scene.outliers(), IsEmpty());
}

TEST(AnchorPosterior, TestsNoneThatHasAnAccuracyOfItsOwn) {
  TestedScene scene;
  scene.left_out.distances[3] = scene.left_out.distances[4] = 0.2;
  scene.anchors.tested[3] = 0;
  EXPECT_THAT(scene.outliers(), ElementsAre(4));
}

TEST(AnchorPosterior, IsIdleWithFewAnchors) {
  EXPECT_TRUE(AnchorPosterior(TestedScene(7).anchors, {}).is_active());
  EXPECT_FALSE(AnchorPosterior(TestedScene(6).anchors, {}).is_active());
}

TEST(AnchorPosterior, TellsNothingWhereMoreThanAThirdWouldGo) {
  TestedScene scene;
  for (const int k : {0, 1, 2, 3}) scene.left_out.distances[k] = 0.5;
  EXPECT_THAT(scene.outliers(), ElementsAre(0, 1, 2, 3));
  scene.left_out.distances[4] = 0.5;
  EXPECT_THAT(scene.outliers(), IsEmpty());
}

}  // namespace
}  // namespace bespoke
