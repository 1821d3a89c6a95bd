#include "bespoke/clearance/nesting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "clearance/balls.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;

constexpr double diagonal_of_ball = 3.46;

TEST(NestingOrder, IsFromTheInsideToTheOutside) {
  EXPECT_THAT(
      nesting_order({test::shell(1.06, 3), test::shell(1.02, 4), test::shell(1.04, 3)}, diagonal_of_ball),
      ElementsAre(1, 2, 0));
}

TEST(NestingOrder, DoesNotDependOnHowFacesAreTurned) {
  TriangleMesh inner = test::shell(1.02, 3);
  inner.faces.row(0).swap(inner.faces.row(1));
  EXPECT_THAT(nesting_order({test::shell(1.04, 3), inner}, diagonal_of_ball), ElementsAre(1, 0));
}

TEST(NestingOrder, KeepsTheListWhereNothingLiesOverAnother) {
  TriangleMesh far = test::shell(1, 2);
  far.vertices.row(0).array() += 10;
  EXPECT_THAT(nesting_order({far, test::shell(1, 2), {Points::Zero(3, 1), Faces(3, 0)}}, diagonal_of_ball),
              ElementsAre(0, 1, 2));
}

}  // namespace
}  // namespace bespoke
