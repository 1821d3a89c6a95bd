#include "bespoke/apply/apply_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <thread>

#include "bespoke/error.h"
#include "bespoke/lattice/atlas_map.h"
#include "bespoke/mapping/elastic_chain.h"
#include "support/elastic_map_contract.h"
#include "support/random_pyramid.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

std::shared_ptr<const ElasticMap> some_map() {
  Pyramid pyramid = test::random_pyramid(3, 1);
  for (PyramidLevel& level : pyramid.levels)
    for (float& value : level.values) value *= 0.01f;
  auto atlas = make_brick_atlas(pyramid, 100);
  return std::make_shared<const AtlasMap>(test::some_affine(), std::move(*atlas), Support{});
}

PointSpans in_place(Points& x) {
  const std::span<double> all(x.data(), static_cast<std::size_t>(x.size()));
  return {all, all};
}

Points applied(const ElasticMap& map, const Points& x, const ApplyPointsOptions& options = {}) {
  Points image = x;
  apply_points(map, test::some_rigid(), in_place(image), options);
  return image;
}

TEST(ApplyPoints, HasTheBitsOfApplyMapping) {
  const auto map = some_map();
  const Points x = test::points_about_random_pyramid(20001, 2);
  for (const double t : {0.0, 0.3, 1.0})
    for (const MappingOrder order : {MappingOrder::elastic_first, MappingOrder::moving_point}) {
      const MotionOptions motion{RotationPath::geodesic, order};
      const AppliedPoints expected = apply_mapping(*map, test::some_rigid(), x, {t}, motion);
      EXPECT_EQ(applied(*map, x, {t, motion, {}}), expected.frames[0]);
    }
}

TEST(ApplyPoints, FollowsTheFlowOfAChain) {
  const ElasticChain chain({some_map(), some_map()});
  const Points x = test::points_about_random_pyramid(9000, 3);
  const MotionOptions motion{RotationPath::flow, MappingOrder::elastic_first};
  EXPECT_EQ(applied(chain, x, {0.7, motion, {}}),
            apply_mapping(chain, test::some_rigid(), x, {0.7}, motion).frames[0]);
}

TEST(ApplyPoints, OfManyProductsIsThatOfEach) {
  const auto map = some_map();
  std::vector<Points> products, expected;
  for (unsigned i = 0; i < 300; ++i) {
    products.push_back(test::points_about_random_pyramid(i % 97 == 0 ? 5000 : i % 61, i));
    expected.push_back(applied(*map, products.back()));
  }
  std::vector<PointSpans> spans;
  for (Points& product : products) spans.push_back(in_place(product));
  const ApplySummary summary = apply_points(*map, test::some_rigid(), spans);
  std::size_t points = 0;
  for (std::size_t i = 0; i < products.size(); ++i) {
    EXPECT_EQ(products[i], expected[i]) << i;
    points += static_cast<std::size_t>(products[i].cols());
  }
  EXPECT_EQ(summary.points, points);
  EXPECT_EQ(summary.in_band + summary.affine_only, points);
  EXPECT_GT(summary.in_band, points / 20);
}

TEST(ApplyPoints, OfNothingIsNothing) {
  Points none(3, 0);
  EXPECT_EQ(apply_points(*some_map(), test::some_rigid(), in_place(none)).points, 0u);
  EXPECT_EQ(apply_points(*some_map(), test::some_rigid(), std::span<const PointSpans>{}).points, 0u);
}

// Several threads at a time on one map, in different orders, each with loops of its own inside.
TEST(ApplyPoints, HasTheSameBitsInSeveralThreadsAtATime) {
  const auto map = some_map();
  std::vector<Points> products, expected;
  for (unsigned i = 0; i < 8; ++i) {
    products.push_back(test::points_about_random_pyramid(15000, i));
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    expected.push_back(applied(*map, products.back()));
  }
  std::vector<std::vector<Points>> found(4, std::vector<Points>(products.size()));
  std::vector<std::thread> threads;
  for (std::size_t n = 0; n < found.size(); ++n)
    threads.emplace_back([&, n] {
      for (std::size_t i = 0; i < products.size(); ++i) {
        const std::size_t product = (i + 2 * n) % products.size();
        found[n][product] = applied(*map, products[product]);
      }
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<Points>& images : found) EXPECT_EQ(images, expected);
}

TEST(ApplyPoints, ReportsProgressAndStopsWhenAsked) {
  const auto map = some_map();
  const Points x = test::points_about_random_pyramid(20000, 4);
  std::vector<std::size_t> done;
  ApplyPointsOptions options;
  options.progress.report = [&](std::string_view, std::size_t now, std::size_t total) {
    EXPECT_EQ(total, 20000u);
    done.push_back(now);
  };
  applied(*map, x, options);
  EXPECT_EQ(done.front(), 0u);
  EXPECT_EQ(done.back(), 20000u);
  std::atomic<int> asked = 0;
  options.progress.cancelled = [&] { return ++asked > 3; };
  EXPECT_THROW(applied(*map, x, options), Interrupted);
}

TEST(ApplyPoints, NamesTheProductThatItCannotCarry) {
  const auto map = some_map();
  Points good = Points::Zero(3, 5), bad = Points::Zero(3, 5);
  bad(2, 3) = std::nan("");
  const std::vector<PointSpans> undefined = {in_place(good), in_place(bad)};
  EXPECT_THAT([&] { apply_points(*map, test::some_rigid(), undefined); },
              ThrowsMessage<InvalidInput>(HasSubstr("product 1: point 3 is not finite")));
  PointSpans short_of_space = in_place(good);
  short_of_space.image = short_of_space.image.first(12);
  EXPECT_THAT([&] { apply_points(*map, test::some_rigid(), short_of_space); },
              ThrowsMessage<InvalidInput>(HasSubstr("product 0: 15 coordinates of points and space for 12")));
  ApplyPointsOptions never;
  never.t = std::nan("");
  EXPECT_THROW(applied(*map, good, never), InvalidInput);
}

}  // namespace
}  // namespace bespoke
