#include "bespoke/clearance/nesting.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "clearance/balls.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;

using ::testing::IsEmpty;
using ::testing::Pair;

constexpr double diagonal_of_ball = 3.46;

/// A strip from corner `from` of a triangle to corner `to`, which rises by 0.04 from below the one to above
/// the other. Its faces look up.
TriangleMesh rising_strip(double from, double to) {
  const auto corner = [](double turn) { return Vector3(std::cos(turn), std::sin(turn), 0); };
  const Vector3 along = corner(to) - corner(from), across = along.cross(Vector3::UnitZ()).normalized();
  TriangleMesh strip = shapes::square_grid(40);
  for (auto vertex : strip.vertices.colwise())
    vertex = corner(from) + (1.2 * vertex.x() - 0.1) * along + 0.2 * (0.5 - vertex.y()) * across +
             Vector3(0, 0, 0.04 * (vertex.x() - 0.5));
  return strip;
}

TEST(Nesting, OrderIsFromTheInsideToTheOutside) {
  EXPECT_THAT(
      nesting_of({test::shell(1.06, 3), test::shell(1.02, 4), test::shell(1.04, 3)}, diagonal_of_ball).order,
      ElementsAre(1, 2, 0));
}

TEST(Nesting, DoesNotDependOnHowFacesAreTurned) {
  TriangleMesh inner = test::shell(1.02, 3);
  inner.faces.row(0).swap(inner.faces.row(1));
  EXPECT_THAT(nesting_of({test::shell(1.04, 3), inner}, diagonal_of_ball).order, ElementsAre(1, 0));
}

TEST(Nesting, KeepsTheListWhereNothingLiesOverAnother) {
  TriangleMesh far = test::shell(1, 2);
  far.vertices.row(0).array() += 10;
  EXPECT_THAT(nesting_of({far, test::shell(1, 2), {Points::Zero(3, 1), Faces(3, 0)}}, diagonal_of_ball).order,
              ElementsAre(0, 1, 2));
}

TEST(Nesting, NamesProductsThatInterleave) {
  TriangleMesh falling = shapes::square_grid(20), rising = falling;
  for (auto vertex : rising.vertices.colwise()) vertex.z() = 0.1 * (vertex.x() - 0.5);
  const Nesting nesting = nesting_of({test::shell(9, 2), rising, falling}, 3);
  EXPECT_THAT(nesting.order, ElementsAre(0, 1, 2));
  EXPECT_THAT(nesting.interleaved, ElementsAre(Pair(1, 2)));
  EXPECT_FALSE(nesting.is_circular);
}

// A sole and the upper that it is glued to: each has area above the other.
TEST(Nesting, GuessesNoOrderOfProductsThatOverlap) {
  TriangleMesh shifted = test::shell(1, 4);
  shifted.vertices.row(2).array() += 0.05;
  const TriangleMesh ball = test::shell(1.02, 4);
  const Nesting nesting = nesting_of({shifted, ball}, diagonal_of_ball);
  EXPECT_THAT(nesting.interleaved, ElementsAre(Pair(0, 1)));
  EXPECT_THAT(nesting.order, ElementsAre(0, 1));
}

TEST(Nesting, TellsThatProductsLieOverEachOtherInACircle) {
  const double third = 2 * std::acos(-1) / 3;
  const std::vector<TriangleMesh> strips = {rising_strip(0, third), rising_strip(third, 2 * third),
                                            rising_strip(2 * third, 0)};
  const Nesting all = nesting_of(strips, 2);
  EXPECT_TRUE(all.is_circular);
  EXPECT_THAT(all.interleaved, IsEmpty());
  EXPECT_THAT(all.order, ElementsAre(0, 2, 1));  // once the first is placed, the third lies under the second
  const Nesting two = nesting_of({strips[0], strips[1]}, 2);
  EXPECT_FALSE(two.is_circular);
  EXPECT_THAT(two.order, ElementsAre(1, 0));
}

}  // namespace
}  // namespace bespoke
