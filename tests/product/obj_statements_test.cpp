#include "bespoke/product/obj/obj_statements.h"

#include <gtest/gtest.h>

#include <random>

namespace bespoke {
namespace {

/// What TextWords reads, word by word.
std::array<std::uint64_t, 3> counted_by_words(const std::string& text) {
  std::array<std::uint64_t, 3> sums{};
  TextBlock block;
  block.bytes = text;
  const std::filesystem::path path;
  TextWords words(block, path, obj_syntax);
  while (words.next_line()) {
    const std::string_view word = words.word();
    sums[0] += word == "v";
    sums[1] += word == "vt";
    sums[2] += word == "vn";
  }
  return sums;
}

TEST(CountObj, CountsWhatIsReadWordByWord) {
  std::mt19937 random(7);
  const std::string letters = "vvvtn  \n\n\r\\\\#1\t";
  for (int i = 0; i < 200000; ++i) {
    std::string text(1 + random() % 12, ' ');
    for (char& c : text) c = letters[random() % letters.size()];
    std::array<std::uint64_t, 3> sums{};
    count_obj(text, sums);
    ASSERT_EQ(sums, counted_by_words(text)) << ::testing::PrintToString(text);
  }
}

}  // namespace
}  // namespace bespoke
