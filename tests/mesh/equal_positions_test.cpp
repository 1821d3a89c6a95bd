#include "bespoke/mesh/equal_positions.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "bespoke/error.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::ElementsAreArray;

const Points some{{1, 0, 1, 0, 1, 1}, {2, 5, 2, 5, 2, 1}, {3, 0, 3, -0.0, 4, 9}};

TEST(EqualPositions, AreGroupedInOrderOfPositionAndOfIndex) {
  const EqualPositions equal = equal_positions(some);
  ASSERT_EQ(equal.groups(), 4u);
  EXPECT_THAT(equal.group(0), ElementsAre(1, 3));  // 0 and -0 are equal
  EXPECT_THAT(equal.group(1), ElementsAre(5));
  EXPECT_THAT(equal.group(2), ElementsAre(0, 2));
  EXPECT_THAT(equal.group(3), ElementsAre(4));
}

TEST(EqualPositions, RegardOnlyTheColumnsAskedFor) {
  const EqualPositions equal = equal_positions(some, {4, 3, 2});
  ASSERT_EQ(equal.groups(), 3u);
  EXPECT_THAT(equal.columns, ElementsAre(3, 2, 4));
}

TEST(EqualPositions, PutEveryColumnIntoOneGroup) {
  Points grid(3, 1000);
  for (Eigen::Index i = 0; i < grid.cols(); ++i) grid.col(i) << double(i * 7 % 10), double(i * 3 % 5), 1;
  const EqualPositions equal = equal_positions(grid);
  EXPECT_EQ(equal.groups(), 10u);  // (7 i mod 10) decides (3 i mod 5)
  std::vector<int> counted(1000, 0);
  for (std::size_t index = 0; index < equal.groups(); ++index)
    for (const int column : equal.group(index)) {
      ++counted[static_cast<std::size_t>(column)];
      EXPECT_EQ(grid.col(column), grid.col(equal.group(index).front()));
    }
  EXPECT_THAT(counted, ElementsAreArray(std::vector<int>(1000, 1)));
}

TEST(EqualPositions, HaveAFirstColumnEach) {
  const std::vector<int> first = first_at_equal_position(some);
  const EqualPositions equal = equal_positions(some);
  for (std::size_t index = 0; index < equal.groups(); ++index)
    for (const int column : equal.group(index))
      EXPECT_EQ(first[static_cast<std::size_t>(column)], equal.group(index).front());
}

TEST(EqualPositions, OfNothingAreNone) { EXPECT_EQ(equal_positions(Points(3, 0)).groups(), 0u); }

TEST(EqualPositions, CannotSortWhatIsNoNumber) {
  Points points = some;
  points(1, 2) = std::nan("");
  EXPECT_THROW(equal_positions(points), InvalidInput);
  EXPECT_EQ(equal_positions(points, {0, 1, 3}).groups(), 2u);
}

}  // namespace
}  // namespace bespoke
