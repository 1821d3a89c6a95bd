#include "bespoke/page/detail/packed_arrays.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

#include "page/unpacked_scene.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

using test::unpacked;
using test::UnpackedScene;
using testing::ElementsAre;

TEST(PackedArrays, GiveBackEveryNumber) {
  PackedArrays arrays;
  const std::vector<std::uint32_t> small{0, 65535, 1, 32768, 32767, 0};
  const std::vector<std::uint32_t> large{0, 0xFFFFFFFFu, 1, 0x80000000u, 7, 7};
  const Json first = arrays.add(small, 16), second = arrays.add(large, 32);
  const UnpackedScene scene = unpacked(packed_scene({{"first", first}, {"second", second}}, arrays));
  EXPECT_EQ(scene.numbers(scene.record["first"]), small);
  EXPECT_EQ(scene.numbers(scene.record["second"]), large);
}

TEST(PackedArrays, RoundPointsByHalfAStepOfTheirBox) {
  const Points points = test::random_points(200, 5).array() * 3.0 + 100.0;
  PackedArrays arrays;
  const Json reference = arrays.add_points(points);
  const UnpackedScene scene = unpacked(packed_scene({{"points", reference}}, arrays));
  const Points found = scene.points(scene.record["points"]);
  const Vector3 step = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()) / 65535;
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_LE((found - points).row(axis).cwiseAbs().maxCoeff(), 0.5 * step[axis] * (1 + 1e-9));
}

TEST(PackedArrays, KeepEveryBitOfExactPoints) {
  Points points = test::random_points(50, 7).array() * 1e3;
  points.col(0) = Vector3(-0.0, 5e-324, 1e308);
  PackedArrays arrays;
  const Json reference = arrays.add_exact_points(points);
  const UnpackedScene scene = unpacked(packed_scene({{"points", reference}}, arrays));
  const std::vector<std::uint32_t> low = scene.numbers(scene.record["points"]["low"]);
  const std::vector<std::uint32_t> high = scene.numbers(scene.record["points"]["high"]);
  ASSERT_EQ(low.size(), 150u);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (Eigen::Index i = 0; i < 50; ++i) {
      const auto at = static_cast<std::size_t>(50 * axis + i);
      EXPECT_EQ(std::bit_cast<std::uint64_t>(points(axis, i)), std::uint64_t{high[at]} << 32 | low[at]);
    }
}

TEST(PackedArrays, FlatBoxesAndNoPointsAreFine) {
  PackedArrays arrays;
  const Json flat = arrays.add_points(Points::Constant(3, 4, 2.5)), none = arrays.add_points(Points(3, 0));
  const UnpackedScene scene = unpacked(packed_scene({{"flat", flat}, {"none", none}}, arrays));
  EXPECT_EQ(scene.points(scene.record["flat"]), Points::Constant(3, 4, 2.5));
  EXPECT_EQ(scene.points(scene.record["none"]).cols(), 0);
}

TEST(PackedArrays, MarkUnknownValues) {
  PackedArrays arrays;
  const Json reference = arrays.add_values({-1, std::nan(""), 3});
  EXPECT_EQ(reference["min"], -1);
  EXPECT_EQ(reference["max"], 3);
  const UnpackedScene scene = unpacked(packed_scene({{"values", reference}}, arrays));
  EXPECT_THAT(scene.numbers(scene.record["values"]["array"]), ElementsAre(0, 65535, 65534));
  PackedArrays others;
  EXPECT_EQ(others.add_values({std::nan("")})["max"], 0);
}

}  // namespace
}  // namespace bespoke
