#include "bespoke/text_lines.h"

#include <gmock/gmock.h>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using namespace std::string_view_literals;

TEST(TextLines, EndAtEveryKindOfLineBreak) {
  EXPECT_THAT(text_lines("\xEF\xBB\xBF"
                         "a\nb\r\nc\rd\r\re\n\nf"),
              ElementsAre("a", "b", "c", "d", "", "e", "", "f"));
  EXPECT_THAT(text_lines("a\r"), ElementsAre("a"));
  EXPECT_TRUE(text_lines("").empty());
  EXPECT_EQ(count_line_breaks("a\nb\r\nc\rd\r\re\n\nf\r"), 8u);
  EXPECT_EQ(first_line_break("a\r\nb\n"), "\r\n");
  EXPECT_EQ(first_line_break("a\rb\n"), "\r");
  EXPECT_EQ(first_line_break("a"), "\n");
}

TEST(TextLines, OfAnyLengthAreFound) {
  for (std::size_t length = 0; length < 600; length += 7)
    for (const std::string line_break : {"\n", "\r", "\r\n"}) {
      const std::string text = std::string(length, 'x') + line_break + "y";
      EXPECT_THAT(text_lines(text), ElementsAre(std::string(length, 'x'), "y"));
    }
}

TEST(TextLines, WideTextsAreNamed) {
  const auto complaint = [](std::string_view head) {
    return test::error_message<FormatError>([&] { require_utf8(head, "a.obj"); });
  };
  EXPECT_EQ(complaint("\xFF\xFEv\0"sv), "a.obj: is UTF-16; save as UTF-8");
  EXPECT_EQ(complaint("\0v\0 \0001\0 \0002"sv), "a.obj: is UTF-16; save as UTF-8");
  EXPECT_EQ(complaint("\xFF\xFE\0\0v\0\0\0"sv), "a.obj: is UTF-32; save as UTF-8");
  for (const std::string_view narrow : {""sv, "v"sv, "v 1 2 3"sv, "\xEF\xBB\xBFv 1 2 3"sv,
                                        "\0\0\0\0\0\0\0\0"sv, "a\0b\0cdef"sv, "\xC3\xA4 umlaut"sv})
    EXPECT_EQ(complaint(narrow), "accepted") << narrow;
}

TEST(TextLines, AFileIsReadWithoutItsMark) {
  const test::ScratchDirectory directory;
  test::write_text(directory / "a.txt", "\xEF\xBB\xBF{}\r\n");
  EXPECT_EQ(read_text_file(directory / "a.txt"), "{}\r\n");
  EXPECT_THAT(test::error_message<FileError>([&] { read_text_file(directory / "none"); }),
              HasSubstr("none: "));
}

}  // namespace
}  // namespace bespoke
