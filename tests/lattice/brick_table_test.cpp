#include "bespoke/lattice/brick_table.h"

#include <gtest/gtest.h>

#include <random>

namespace bespoke {
namespace {

std::vector<BrickTable::Reference> find(const BrickTable& table,
                                        const std::vector<LatticeCoordinates>& places) {
  std::array<std::vector<std::int32_t>, 3> axes;
  for (const LatticeCoordinates& place : places)
    for (std::size_t axis = 0; axis < 3; ++axis) axes[axis].push_back(place[axis]);
  std::vector<BrickTable::Reference> found(places.size());
  table.find(axes[0].data(), axes[1].data(), axes[2].data(), places.size(), found.data());
  return found;
}

std::vector<LatticeCoordinates> cube(int low, int high) {
  std::vector<LatticeCoordinates> places;
  for (int i = low; i < high; ++i)
    for (int j = low; j < high; ++j)
      for (int k = low; k < high; ++k) places.push_back({i, j, k});
  return places;
}

// Nested regions of random sizes, found again place by place, whatever the grid's resolution.
TEST(BrickTable, FindsTheSmallestRegionThatWasSet) {
  const std::vector<LatticeCoordinates> places = cube(-16, 16);
  for (const std::size_t largest_grid : {27u, 200u, 5000u, 100000u}) {
    std::mt19937 engine(7);
    BrickTable table({-16, -16, -16}, {16, 16, 16}, largest_grid);
    std::vector<BrickTable::Reference> expected(places.size(), 0);
    BrickTable::Reference next = 0;
    for (int bits = 4; bits >= 0; --bits) {
      std::uniform_int_distribution<int> coordinate(-(16 >> bits), (16 >> bits) - 1);
      for (int n = 0; n < 60; ++n) {
        const LatticeCoordinates region = {coordinate(engine), coordinate(engine), coordinate(engine)};
        table.set(region, bits, ++next);
        for (std::size_t i = 0; i < places.size(); ++i)
          if (places[i][0] >> bits == region[0] && places[i][1] >> bits == region[1] &&
              places[i][2] >> bits == region[2])
            expected[i] = next;
      }
    }
    EXPECT_EQ(find(table, places), expected) << largest_grid;
  }
}

TEST(BrickTable, IsEmptyInTheLayerBelowItsBox) {
  BrickTable table({0, 0, 0}, {4, 4, 4}, 1000);
  for (const LatticeCoordinates& place : cube(0, 4)) table.set(place, 0, 1);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_LT(table.low()[static_cast<std::size_t>(axis)], 0);
    LatticeCoordinates place = {1, 1, 1};
    place[static_cast<std::size_t>(axis)] = table.low()[static_cast<std::size_t>(axis)];
    EXPECT_EQ(find(table, {place}).front(), 0u);
  }
  EXPECT_EQ(find(table, {table.low()}).front(), 0u);
}

TEST(BrickTable, StaysSmallWhereRegionsAreFarApart) {
  const int far = 1 << 28;
  BrickTable table({-far, -far, -far}, {far, far, far}, 27);
  table.set({-far, 5, 6}, 0, 1);
  table.set({far - 1, -7, 8}, 0, 2);
  EXPECT_EQ(find(table, {{-far, 5, 6}, {far - 1, -7, 8}, {0, 0, 0}}),
            (std::vector<BrickTable::Reference>{1, 2, 0}));
  EXPECT_LT(table.byte_count(), 10000u);
}

}  // namespace
}  // namespace bespoke
