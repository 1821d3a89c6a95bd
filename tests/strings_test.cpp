#include "bespoke/strings.h"

#include <gtest/gtest.h>

#include "bespoke/json_reason.h"

namespace bespoke {
namespace {

TEST(Words, AreLowerInAsciiAlone) {
  EXPECT_EQ(lower_case("Ä-Z_a9[]@`"), "Ä-z_a9[]@`");
  EXPECT_EQ(lower_case(""), "");
}

TEST(Words, EndNames) {
  EXPECT_EQ(lower_ending("Sizes.M/Dress.OBJ"), ".obj");
  EXPECT_EQ(lower_ending("map.NII.gz"), ".gz");
  EXPECT_EQ(lower_ending("dress"), "");
  EXPECT_EQ(lower_ending(".obj"), "");
}

TEST(Words, AreListedAsAlternatives) {
  EXPECT_EQ(alternatives({}), "");
  EXPECT_EQ(alternatives({"a"}), "a");
  EXPECT_EQ(alternatives({"a", "b"}), "a or b");
  EXPECT_EQ(alternatives({"a", "b", "c"}), "a, b or c");
}

TEST(JsonReason, IsTheSentenceAlone) {
  EXPECT_EQ(json_reason("[json.exception.out_of_range.403] key 'unit' not found"), "key 'unit' not found");
  EXPECT_EQ(json_reason("[1] is a place] of its own"), "[1] is a place] of its own");
  EXPECT_EQ(json_reason(""), "");
}

}  // namespace
}  // namespace bespoke
