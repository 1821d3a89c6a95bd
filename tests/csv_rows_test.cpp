#include "bespoke/csv_rows.h"

#include <gmock/gmock.h>

namespace bespoke {
namespace {

using ::testing::ElementsAre;

TEST(CsvRow, DividesCellsAtItsSeparatorOnly) {
  EXPECT_THAT(csv_row("a, b ,,\"c, d\"\r\n", ',').cells, ElementsAre("a", "b", "", "\"c, d\""));
  EXPECT_THAT(csv_texts(csv_row("0,5;\" x \";\"say \"\"a;b\"\"\"", ';')),
              ElementsAre("0,5", " x ", "say \"a;b\""));
  EXPECT_THAT(csv_texts(csv_row("\t5\" wide\t", '\t')), ElementsAre("", "5\" wide", ""));
  EXPECT_THAT(csv_texts(csv_row("", ',')), ElementsAre(""));
  EXPECT_TRUE(csv_row("\"a\"\"\"", ',').is_closed);
  EXPECT_FALSE(csv_row("a,\"b", ',').is_closed);
}

TEST(CsvRow, IsWhatCsvCellWrites) {
  for (const std::string text : {"", "chin", "chin, left", "a;b", "tab\there", "\"", "\"\"", "say \"x\""})
    for (const char separator : {',', ';', '\t'})
      EXPECT_THAT(csv_texts(csv_row(csv_cell(text) + separator + "1", separator)), ElementsAre(text, "1"));
}

TEST(CsvSeparator, IsTheFirstThatFits) {
  const auto has_x = [](const std::vector<std::string>& cells) {
    return cells.size() == 3 && cells[1] == "x";
  };
  EXPECT_EQ(csv_separator("a,x,b", has_x), ',');
  EXPECT_EQ(csv_separator("\"a;x\";x;b", has_x), ';');
  EXPECT_EQ(csv_separator("a\tx\tb", has_x), '\t');
  EXPECT_FALSE(csv_separator("a x b", has_x).has_value());
  EXPECT_EQ(csv_named_separator("sep=;\r\n"), ';');
  EXPECT_FALSE(csv_named_separator("sep=x").has_value());
}

TEST(DecimalComma, HasDigitsOnBothSides) {
  for (const char* text : {"0,5", "-12,25", "1,5e-3"}) EXPECT_TRUE(has_decimal_comma(text)) << text;
  for (const char* text : {"", ",", "1,", ",5", "1,2,3", "1.234,5", "a,b", "12"})
    EXPECT_FALSE(has_decimal_comma(text)) << text;
}

}  // namespace
}  // namespace bespoke
