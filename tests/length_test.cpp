#include "bespoke/length.h"

#include <gtest/gtest.h>

namespace bespoke {
namespace {

TEST(Length, IsMeshUnitsOrPerCentOfADiagonal) {
  EXPECT_EQ(parse_length("0.25")->in_mesh_units(40), 0.25);
  EXPECT_EQ(parse_length("25%")->in_mesh_units(40), 10);
  EXPECT_EQ(parse_length("1e-3")->in_mesh_units(40), 1e-3);
  EXPECT_EQ(parse_length("0", LengthRange::not_negative)->in_mesh_units(40), 0);
}

TEST(Length, RefusesWhatIsNoLengthOfItsRange) {
  for (const char* text : {"", "%", "1 %", "1%%", "ten", "1mm", "-1", "0", "0%", "nan", "inf", "1e999"})
    EXPECT_FALSE(parse_length(text)) << text;
  EXPECT_FALSE(parse_length("-1e-9", LengthRange::not_negative));
}

}  // namespace
}  // namespace bespoke
