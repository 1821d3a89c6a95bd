#include "bespoke/mesh/disjoint_sets.h"

#include <gtest/gtest.h>

#include <random>

namespace bespoke {
namespace {

TEST(DisjointSets, AreOneEachAtFirst) {
  DisjointSets sets(4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(sets.least(i), i);
}

TEST(DisjointSets, NameTheLeastOfTheirNumbers) {
  DisjointSets sets(6);
  EXPECT_TRUE(sets.join(5, 3));
  EXPECT_TRUE(sets.join(3, 1));
  EXPECT_FALSE(sets.join(1, 5));
  for (const int i : {1, 3, 5}) EXPECT_EQ(sets.least(i), 1);
  for (const int i : {0, 2, 4}) EXPECT_EQ(sets.least(i), i);
}

TEST(DisjointSets, AgreeWithTheComponentsOfAGraph) {
  // Numbers of equal remainder by 7 are joined in random order; never others.
  constexpr int count = 500, modulus = 7;
  DisjointSets sets(count);
  std::mt19937 random(3);
  std::uniform_int_distribution<int> number(0, count / modulus - 1);
  int joined = 0;
  for (int i = 0; i + modulus < count; ++i) joined += sets.join(i + modulus, i) ? 1 : 0;
  for (int k = 0; k < 1000; ++k) {
    const int remainder = k % modulus;
    EXPECT_FALSE(sets.join(modulus * number(random) + remainder, modulus * number(random) + remainder));
  }
  EXPECT_EQ(joined, count - modulus);
  for (int i = 0; i < count; ++i) EXPECT_EQ(sets.least(i), i % modulus);
}

}  // namespace
}  // namespace bespoke
