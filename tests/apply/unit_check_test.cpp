#include "bespoke/apply/unit_check.h"

#include <gmock/gmock.h>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

/// A model of radius 10 about (0, 0, 100), and a map that acts as far as 20.
const Box model(Vector3(-10, -10, 90), Vector3(10, 10, 110));

std::string refusal(const Points& points) {
  const AnalyticMap map({{Vector3(0, 0, 100), 20, Vector3(1, 0, 0)}});
  return test::error_message<InvalidInput>([&] { require_unit_of_map("a.obj", points, map, model); });
}

Points around_model() { return (7 * Points::Random(3, 5000)).colwise() + Vector3(0, 0, 100); }

TEST(UnitCheck, NamesTheFactorOfAnotherUnit) {
  EXPECT_EQ(refusal(around_model()), "accepted");
  for (const double factor : {10.0, 100.0, 1000.0, 25.4, 2.54}) {
    EXPECT_THAT(refusal(around_model() / factor), HasSubstr("a.obj: none of its points is near the model"));
    EXPECT_THAT(refusal(around_model() * factor), HasSubstr("as if it were in another unit"));
  }
  EXPECT_THAT(refusal(around_model() / 100), HasSubstr("multiplied by 100 they would be"));
}

TEST(UnitCheck, LeavesWhatIsElsewhereOrPartlyNear) {
  EXPECT_EQ(refusal(around_model().colwise() + Vector3(500, 0, 0)), "accepted");  // in no unit near it
  EXPECT_EQ(refusal(1000 * Points::Random(3, 500)), "accepted");                  // a landscape
  EXPECT_EQ(refusal(Points(3, 0)), "accepted");
  EXPECT_EQ(refusal(Points::Constant(3, 1, 1e6)), "accepted");
}

// Of twenty factors one fits a few points by chance: they are carried, with a warning.
TEST(UnitCheck, WarnsOfAFewPoints) {
  const AnalyticMap map({{Vector3(0, 0, 100), 20, Vector3(1, 0, 0)}});
  const Points few = around_model().leftCols(3) / 100;
  std::string warning;
  ASSERT_EQ(
      test::error_message<InvalidInput>([&] { warning = require_unit_of_map("a.obj", few, map, model); }),
      "accepted");
  EXPECT_THAT(warning, HasSubstr("multiplied by 100 they would be"));
  EXPECT_EQ(require_unit_of_map("a.obj", around_model(), map, model), "");
}

// As small in the band as a button, or as large as no garment: near the origin some of it is always in reach.
TEST(UnitCheck, TellsWhatIsInReachAndOfNoUsualSize) {
  const Box about_origin(Vector3(-10, -10, -10), Vector3(10, 10, 10));
  const AnalyticMap map({{Vector3(0, 0, 0), 20, Vector3(1, 0, 0)}});
  const Points product = 7 * Points::Random(3, 5000);
  const auto warning = [&](const Points& points) {
    return require_unit_of_map("a.obj", points, map, about_origin);
  };
  EXPECT_EQ(warning(product), "");
  for (const double factor : {39.37, 100.0, 1000.0}) {
    EXPECT_THAT(warning(product / factor), HasSubstr("of the model's, but multiplied by"));
    EXPECT_THAT(test::error_message<InvalidInput>([&] { warning(product * factor); }),
                HasSubstr("as if it were in another unit"));
  }
  EXPECT_THAT(warning(product / 100), HasSubstr("multiplied by 100 it would lie around it"));
  const Points button = (0.1 * Points::Random(3, 500)).colwise() + Vector3(0, 0, 10);
  EXPECT_EQ(warning(button), "");
}

}  // namespace
}  // namespace bespoke
