#include "bespoke/length.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

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

TEST(PowerOfTwoScale, CountsDoublingsAndHalvings) {
  for (const double same : {0.56, 0.9, 1.0, 1.1, 1.8}) EXPECT_EQ(power_of_two_scale(same), 1) << same;
  for (const double size_scale : {0.125, 0.25, 0.5, 2.0, 4.0, 8.0})
    for (const double ratio : {0.98 * size_scale, size_scale, 1.02 * size_scale})
      EXPECT_EQ(power_of_two_scale(ratio), size_scale);
  EXPECT_EQ(power_of_two_scale(3.5), 2);
  EXPECT_EQ(power_of_two_scale(0.3), 0.5);
  for (const double none : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(power_of_two_scale(none), 1) << none;
}

}  // namespace
}  // namespace bespoke
