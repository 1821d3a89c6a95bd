#include "bespoke/registration/fit_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "bespoke/error.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

FitSummary summary_of_all_stages() {
  FitSummary summary;
  summary.rigid = {false, std::numbers::pi / 2, std::nullopt, summarize({0.5, 1.5}), 7};
  summary.coarse.emplace().residuals = summarize({0.25});
  summary.surface.emplace().iterations = 42;
  summary.elastic.found = MultiscaleSummary{{2, 1}, {10, 40}, {0.9, 0.5}, {}, 12, 7};
  summary.elastic.lambda = 2;
  summary.bake.emplace().folded_cells = 3;
  return summary;
}

std::vector<std::string> names(const std::vector<StageLine>& lines) {
  std::vector<std::string> result;
  for (const StageLine& line : lines) result.push_back(line.name);
  return result;
}

TEST(FitSummary, HasOneLineForEveryStageThatRan) {
  FitSummary summary = summary_of_all_stages();
  for (const StageLine& stage : stage_lines(summary, {})) {
    EXPECT_FALSE(stage.line.empty()) << stage.name;
    EXPECT_EQ(stage.line.find('\n'), std::string::npos) << stage.name;
  }
  EXPECT_THAT(names(stage_lines(summary, {})),
              ElementsAre("rigid", "coarse", "surface-fit", "elastic", "bake"));
  summary.coarse.reset();
  summary.surface.reset();
  summary.bake.reset();
  const std::vector<StageLine> lines = stage_lines(summary, {});
  EXPECT_THAT(names(lines), ElementsAre("rigid", "surface-fit", "elastic"));
  EXPECT_THAT(lines[1].line, HasSubstr("given"));
}

TEST(RigidSummary, BetweenTwoUnitsHasResidualsOfTheSimilarity) {
  // In micrometres and in millimetres, one place 0.5 mm off.
  const Points sources{{0, 9e4, 0, 0, 5e4}, {0, 0, 8e4, 0, 5e4}, {0, 0, 0, 7e4, 5e4}};
  Points targets = 1e-3 * sources;
  targets(2, 4) += 0.5;
  const RigidSummary found = rigid_summary({}, sources, targets);
  ASSERT_TRUE(found.scale);
  EXPECT_NEAR(*found.scale, 1e-3, 1e-5);
  EXPECT_LT(found.residuals.max, 0.5);
  EXPECT_THAT(to_string(found), HasSubstr("scaled by 0.001"));
  EXPECT_TRUE(to_json(found).contains("scale"));

  const RigidSummary one_unit = rigid_summary({}, sources, 2 * sources);
  EXPECT_FALSE(one_unit.scale);
  EXPECT_NEAR(one_unit.residuals.max, 9e4, 1);
  EXPECT_FALSE(to_json(one_unit).contains("scale"));
}

TEST(FitSummary, LinesNameWhatWasLeftOut) {
  ElasticSummary summary;
  EXPECT_THAT(to_string(summary), Not(HasSubstr("unreferenced")));
  summary.unreferenced_vertices = 1;
  summary.duplicate_vertices = 3;
  summary.anchors_off_surface = 2;
  EXPECT_THAT(to_string(summary), HasSubstr("1 unreferenced vertices left out; 3 duplicate vertices merged; "
                                            "2 anchors off the surface matched as points"));
  summary.meets_anchors_off_surface = false;
  EXPECT_THAT(to_string(summary), HasSubstr("2 anchors off the surface left out: p-FFD uses faces only"));
}

TEST(StagesJson, HoldTheFieldsWithoutTimes) {
  const std::vector<StageJson> stages = stages_json(summary_of_all_stages(), {});
  ASSERT_EQ(stages.size(), 5u);
  for (const StageJson& stage : stages) {
    EXPECT_EQ(stage.json.begin().key(), "name");
    EXPECT_FALSE(stage.json.contains("seconds"));
  }
  EXPECT_EQ(stages[0].seconds, 7);
  EXPECT_EQ(stages[0].json["pairs_of"], "anchors");
  EXPECT_EQ(stages[0].json["rotation_degrees"], 90);
  EXPECT_EQ(stages[0].json["residual"]["max"], 1.5);
  EXPECT_EQ(stages[1].json["pairs"], 1);
  EXPECT_EQ(stages[2].json["iterations"], 42);
  EXPECT_EQ(stages[3].json["method"], "diffeomorphic");
  EXPECT_EQ(stages[3].json["lambdas"], Json::array({2.0, 1.0}));
  EXPECT_EQ(stages[3].json["centers"], Json::array({10, 40}));
  EXPECT_EQ(stages[3].json["within_tolerance"], 12);
  EXPECT_FALSE(stages[3].json.contains("anchors_off_surface"));
  EXPECT_EQ(stages[4].json["folded_cells"], 3);
}

TEST(StagesJson, RefuseAMethodWithoutAName) {
  FitSummary summary = summary_of_all_stages();
  summary.elastic.method = static_cast<ElasticMethod>(99);
  EXPECT_THROW(stages_json(summary, {}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
