#include "bespoke/grading/grade_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/mapping/affine_map.h"
#include "support/analytic_map.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

OpenedMap scaling(double factor) {
  const AffineMap affine{factor * Matrix3::Identity(), Vector3(1, 2, 3)};
  return {std::make_shared<AnalyticMap>(std::vector<Bump>{}, affine), RigidTransform{},
          RotationPath::geodesic, 2};
}

TEST(GradedMeasures, ScaleWithTheMapAndItsTime) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const SizeModel model{shapes::moved(sphere, scaling(1.5).elastic->affine()), {}};
  const std::vector<MeasureLine> lines =
      measure_lines({{"round", Plane{{0, 0.3, 0}, {0, 1, 0}}},
                     {"side", AnchorLine{{Vector3(0, 1, 0), Vector3(1, 0, 0)}, false}}},
                    sphere, {});
  const std::vector<GradedMeasure> whole = graded_measures(lines, scaling(1.5), 1, &model);
  ASSERT_EQ(whole.size(), 2u);
  for (const GradedMeasure& measure : whole) {
    EXPECT_NEAR(measure.carried, 1.5 * measure.source, 1e-12 * measure.source) << measure.name;
    EXPECT_NEAR(measure.model.value(), measure.carried, 1e-6 * measure.carried) << measure.name;
  }
  const std::vector<GradedMeasure> half = graded_measures(lines, scaling(1.5), 0.5, nullptr);
  EXPECT_NEAR(half[0].carried, 1.25 * half[0].source, 1e-12);
  EXPECT_FALSE(half[0].model);
}

class GradeTables : public ::testing::Test {
 protected:
  GradedSeries series_{"cm",
                       1,
                       {{"S", {{"hips, low", 90, 94.25, 94}, {"a|b", 10, 9.5, {}}}},
                        {"L", {{"hips, low", 90, 106, 106.5}, {"a|b", 10, 12, {}}}}}};
};

TEST_F(GradeTables, OfASizeHoldSourceModelAndCarried) {
  EXPECT_EQ(size_csv(series_.sizes[0]),
            "measure,source,model,carried\n\"hips, low\",90,94,94.25\na|b,10,,9.5\n");
  EXPECT_EQ(size_markdown(series_, series_.sizes[0]),
            "# S\n\n| measure (cm) | source | model | carried | carried − source |\n|---|---|---|---|---|\n"
            "| hips, low | 90.0 | 94.0 | 94.2 | +4.2 |\n| a\\|b | 10.0 |  | 9.5 | -0.5 |\n");
}

TEST_F(GradeTables, OfASeriesHaveAColumnASize) {
  EXPECT_EQ(series_csv(series_),
            "measure,on,source,S,L\n\"hips, low\",model,90,94,106.5\n\"hips, low\",carried,90,94.25,106\n"
            "a|b,model,10,,\na|b,carried,10,9.5,12\n");
  EXPECT_EQ(series_markdown(series_),
            "Lengths on the models of the sizes.\n\n| measure (cm) | source | S | L |\n|---|---|---|---|\n"
            "| hips, low | 90.0 | 94.0 | 106.5 |\n| a\\|b | 10.0 |  |  |\n");
}

// Lengths on a model and carried ones in one row would show a step that no size has.
TEST_F(GradeTables, OfASeriesWithoutAllModelsAreOfWhatIsCarried) {
  series_.sizes[1].measures[0].model.reset();
  EXPECT_EQ(series_csv(series_),
            "measure,on,source,S,L\n\"hips, low\",carried,90,94.25,106\na|b,carried,10,9.5,12\n");
  EXPECT_EQ(
      series_markdown(series_),
      "Lengths on the source, carried to the sizes.\n\n| measure (cm) | source | S | L |\n|---|---|---|---|\n"
      "| hips, low | 90.0 | 94.2 | 106.0 |\n| a\\|b | 10.0 | 9.5 | 12.0 |\n");
}

TEST(LengthDecimals, ShowATenthOfAMillimetreOfABody) {
  EXPECT_THAT(
      (std::vector{length_decimals(1900), length_decimals(190), length_decimals(19), length_decimals(1.9)}),
      ElementsAre(1, 2, 3, 4));
  EXPECT_EQ(length_decimals(1e6), 0);
}

}  // namespace
}  // namespace bespoke
