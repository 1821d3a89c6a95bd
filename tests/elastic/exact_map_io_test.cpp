#include "bespoke/elastic/exact_map_io.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <random>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/elastic/multiscale.h"
#include "bespoke/elastic/pffd.h"
#include "bespoke/elastic/pffd_smooth.h"
#include "bespoke/error.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::random_points;

AffineMap some_affine() {
  return {Matrix3::Identity() + 0.1 * Matrix3(random_points(3, 7)), Vector3(1, 2, 3)};
}

std::vector<std::shared_ptr<const ElasticMap>> maps() {
  const TriangleMesh sphere = shapes::icosphere(1);
  const Points moved = sphere.vertices + 0.1 * random_points(sphere.vertices.cols(), 8);
  std::vector<RbfLayer> layers = {{0.7, random_points(9, 1), 0.05 * random_points(9, 2)},
                                  {0.3, random_points(20, 3), 0.02 * random_points(20, 4)}};
  return {std::make_shared<CsrbfMap>(random_points(30, 5), random_points(30, 6), some_affine(), 0.6),
          std::make_shared<MultiscaleMap>(some_affine(), layers, false),
          std::make_shared<MultiscaleMap>(some_affine(), layers, true),
          std::make_shared<PffdMap>(sphere, moved, 0.4), std::make_shared<SmoothPffdMap>(sphere, moved, 0.4)};
}

TEST(ExactMapIo, ComesBackBitByBit) {
  const Points x = random_points(500, 11);
  for (const auto& map : maps()) {
    const std::string bytes = serialize_exact_map(*map);
    const auto back = parse_exact_map(bytes);
    EXPECT_EQ((*back)(x), (*map)(x));
    EXPECT_EQ(back->displacement_gradient(x), map->displacement_gradient(x));
    EXPECT_EQ(serialize_exact_map(*back), bytes);
  }
}

TEST(ExactMapIo, RejectsEveryTruncationAndEveryTail) {
  for (const auto& map : maps()) {
    const std::string bytes = serialize_exact_map(*map);
    for (std::size_t size = 0; size < bytes.size(); size += size < 200 ? 1 : 37)
      EXPECT_THROW(parse_exact_map(std::string_view(bytes).substr(0, size)), FormatError);
    EXPECT_THROW(parse_exact_map(bytes + "x"), FormatError);
  }
}

TEST(ExactMapIo, RejectsSizesThatDoNotFit) {
  for (const auto& map : maps()) {
    const std::string bytes = serialize_exact_map(*map);
    // Every 64-bit word in turn becomes a huge integer, which is no finite number either.
    for (std::size_t at = 16; at + 8 <= std::min<std::size_t>(bytes.size(), 400); at += 4) {
      std::string damaged = bytes;
      std::memset(damaged.data() + at, 0xFF, 8);
      EXPECT_THROW(parse_exact_map(damaged), FormatError) << "at byte " << at;
    }
  }
}

TEST(ExactMapIo, RejectsADamagedMapOrReadsAFiniteOne) {
  const Points x = random_points(200, 12);
  std::mt19937 generator(3);
  for (const auto& map : maps()) {
    const std::string bytes = serialize_exact_map(*map);
    int rejected = 0, read = 0;
    constexpr int rounds = 300;
    for (int round = 0; round < rounds; ++round) {
      std::string damaged = bytes;
      damaged[generator() % damaged.size()] ^= static_cast<char>(1 << generator() % 8);
      // Any other exception ends the test.
      std::shared_ptr<const ElasticMap> back;
      try {
        back = parse_exact_map(damaged);
      } catch (const FormatError&) {
        ++rejected;
        continue;
      }
      ++read;
      EXPECT_TRUE((*back)(x).allFinite()) << "round " << round;
      EXPECT_TRUE(back->displacement_gradient(x).allFinite()) << "round " << round;
      // What was read is a map of its own: it is written with the damage, not without.
      EXPECT_EQ(serialize_exact_map(*back), damaged) << "round " << round;
    }
    EXPECT_EQ(rejected + read, rounds);
    // Nearly all bits are of numbers, and most of those leave them finite.
    EXPECT_GT(read, rounds / 2);
    EXPECT_GT(rejected, 0);
  }
}

TEST(ExactMapIo, NamesVersionAndType) {
  std::string bytes = serialize_exact_map(*maps().front());
  const auto message = [](const std::string& damaged) {
    try {
      parse_exact_map(damaged);
    } catch (const FormatError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  std::string other = bytes;
  other[8] = 9;
  EXPECT_NE(message(other).find("version 9"), std::string::npos);
  other = bytes;
  other[12] = 9;
  EXPECT_NE(message(other).find("type 9"), std::string::npos);
  EXPECT_THROW(parse_exact_map("not a map at all, not a map at all"), FormatError);
}

TEST(ExactMapIo, RefusesMapsThatAreNotExact) {
  class Other : public ElasticMap {
    AffineMap affine() const override { return {}; }
    Points displacement(const Points& x) const override { return 0 * x; }
    Points displacement_gradient(const Points& x) const override { return Points::Zero(3, 3 * x.cols()); }
    Support support() const override { return {}; }
  };
  EXPECT_THROW(serialize_exact_map(Other()), InvalidInput);
}

}  // namespace
}  // namespace bespoke
