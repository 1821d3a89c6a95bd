#include "bespoke/number_format.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>

namespace bespoke {
namespace {

TEST(Digits, AreThoseOfPrintf) {
  std::mt19937_64 engine(5);
  for (int i = 0; i < 10'000; ++i) {
    const double value = std::ldexp(static_cast<double>(static_cast<std::int64_t>(engine())),
                                    static_cast<int>(engine() % 400) - 260);
    for (const int digits : {3, 6, 17}) {
      char text[40];
      std::snprintf(text, sizeof text, "%.*g", digits, value);
      EXPECT_EQ(format_number(value, digits), text);
    }
    EXPECT_EQ(std::strtod(format_number(value, 17).c_str(), nullptr), value);
  }
}

TEST(Digits, OfAVectorStandInBrackets) {
  EXPECT_EQ(format_number(Vector3(0.5, -2, 1e-9), 4), "(0.5, -2, 1e-09)");
}

}  // namespace
}  // namespace bespoke
