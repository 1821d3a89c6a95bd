#include "bespoke/mapping/scaled_map.h"

#include <gmock/gmock.h>

#include "bespoke/mapping/elastic_chain.h"
#include "support/elastic_map_contract.h"

namespace bespoke {
namespace {

using namespace test;

TEST(ScaledMap, IsTheMapOfPointsInAnotherUnit) {
  const auto map = std::make_shared<AnalyticMap>(strong_bumps());
  for (const double scale : {0.01, 2.54, 100.0}) {
    const std::shared_ptr<const ElasticMap> other = in_other_unit(map, scale);
    const Points x = near_and_far() / scale;
    const Points expected = (*map)(scale * x) / scale;
    EXPECT_LT(((*other)(x)-expected).cwiseAbs().maxCoeff() * scale, 1e-12);
    EXPECT_EQ(other->displacement_gradient(x), map->displacement_gradient(scale * x));
    expect_support_holds(*other, x);
  }
}

TEST(ScaledMap, OfAChainIsAChain) {
  const ElasticChain chain(
      {std::make_shared<AnalyticMap>(strong_bumps(0.2)), std::make_shared<AnalyticMap>(strong_bumps(-0.2))});
  const auto other = in_other_unit(std::make_shared<ElasticChain>(chain), 100);
  const auto* const steps = dynamic_cast<const ElasticChain*>(other.get());
  ASSERT_NE(steps, nullptr);
  const Points x = Points::Random(3, 100);
  EXPECT_LT((100 * steps->at(x / 100, 0.7) - chain.at(x, 0.7)).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(ScaledMap, OfTheSameUnitIsTheMapItself) {
  const std::shared_ptr<const ElasticMap> map = std::make_shared<AnalyticMap>(strong_bumps());
  EXPECT_EQ(in_other_unit(map, 1), map);
}

}  // namespace
}  // namespace bespoke
