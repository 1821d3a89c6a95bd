#include "bespoke/mapping/elastic_chain.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/finite_differences.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

std::shared_ptr<const ElasticMap> step(unsigned seed) {
  const AffineMap affine{Matrix3::Identity() + 0.1 * test::random_rotation(seed),
                         0.1 * test::random_points(1, seed).col(0)};
  return std::make_shared<const AnalyticMap>(
      std::vector<Bump>{{Vector3(0.1, 0.2, 0), 1.2, Vector3(0.1, -0.05, 0.08)}}, affine);
}

ElasticChain chain_of_three() { return ElasticChain({step(1), step(2), step(3)}); }

TEST(ElasticChain, AppliesItsStepsInTheirOrder) {
  const ElasticChain chain = chain_of_three();
  const Points x = test::random_points(100, 4);
  Points expected = x;
  for (const auto& map : chain.steps()) expected = (*map)(expected);
  EXPECT_LT((chain(x) - expected).norm(), 1e-12);
}

TEST(ElasticChain, OfOneStepHasItsBits) {
  const auto only = step(5);
  const ElasticChain chain({only});
  const Points x = test::random_points(50, 6);
  EXPECT_EQ(chain.displacement(x), only->displacement(x));
  EXPECT_EQ(chain.displacement_gradient(x), only->displacement_gradient(x));
  EXPECT_EQ(chain.affine().linear, only->affine().linear);
  EXPECT_EQ(chain(x), (*only)(x));
}

TEST(ElasticChain, IsExactlyAffineOutsideItsSupport) {
  const ElasticChain chain = chain_of_three();
  const Points far = 100 * test::sphere_points(50);
  EXPECT_EQ(chain.displacement(far), Points::Zero(3, 50));
  EXPECT_EQ(chain.displacement_gradient(far), Points::Zero(3, 150));
}

TEST(ElasticChain, SupportHoldsAllDisplacements) {
  const ElasticChain chain = chain_of_three();
  const Support support = chain.support();
  ASSERT_EQ(support.clouds.size(), 3u);
  const Points x = 3 * test::random_points(3000, 7);
  const Points u = chain.displacement(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (u.col(i).norm() == 0) continue;
    bool inside = false;
    // Points are moved by the steps before the one that acts on them, by 0.15 a step at most.
    constexpr double moved = 0.3 * 1.5;
    for (const BallCloud& cloud : support.clouds)
      inside = inside ||
               (cloud.centers.colwise() - (support.frame * Vector3(x.col(i)))).colwise().norm().minCoeff() <=
                   cloud.radius + moved;
    EXPECT_TRUE(inside) << x.col(i).transpose();
  }
}

TEST(ElasticChain, GradientIsThatOfItsDisplacement) {
  const ElasticChain chain = chain_of_three();
  const Points x = 0.6 * test::random_points(50, 8);
  const Points expected = test::finite_differences(chain, x, 1e-5);
  EXPECT_LT((chain.displacement_gradient(x) - expected).cwiseAbs().maxCoeff(), 1e-7);
}

TEST(ElasticChain, TakesItsStepsOneAfterTheOther) {
  const ElasticChain chain = chain_of_three();
  const Points x = test::random_points(20, 9);
  const Points one = (*chain.steps()[0])(x), two = (*chain.steps()[1])(one);
  EXPECT_EQ(chain.at(x, 0), x);
  EXPECT_EQ(chain.at(x, 1), (*chain.steps()[2])(two));
  EXPECT_LT((chain.at(x, 1.0 / 6) - (x + one) / 2).norm(), 1e-12);
  EXPECT_LT((chain.at(x, 0.5) - (one + two) / 2).norm(), 1e-12);
  EXPECT_LT((chain.at(x, -0.1) - (1.3 * x - 0.3 * one)).norm(), 1e-12);
  const std::vector<Points> frames = chain.at(x, std::vector<double>{0.9, 0, 0.5});
  EXPECT_EQ(frames[0], chain.at(x, 0.9));
  EXPECT_EQ(frames[1], x);
  EXPECT_EQ(frames[2], chain.at(x, 0.5));
}

TEST(ElasticChain, RejectsNoStepsAndNoTime) {
  EXPECT_THROW(ElasticChain({}), InvalidInput);
  EXPECT_THROW(chain_of_three().at(Points::Zero(3, 1), std::numeric_limits<double>::infinity()),
               InvalidInput);
}

}  // namespace
}  // namespace bespoke
