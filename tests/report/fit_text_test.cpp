#include "bespoke/report/fit_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "asset/small_asset.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// What a fit would have found, in dm.
class FitText : public testing::Test {
 protected:
  FitText() {
    made_.asset = test::small_asset();
    made_.fit = fit_;
    FitSummary& summary = fit_->summary;
    summary.surface.emplace();
    summary.surface->after = summarize({0.1, 0.25, 0.75});
    summary.elastic.anchor_residuals = summarize({0.5, 2});
    summary.bake.emplace();
    summary.bake->error = summarize({0.0005});
    summary.bake->tolerance_met = true;
    fit_->confidence.assign(static_cast<std::size_t>(mesh_.vertices.cols()), 1);
    fit_->anchor_residual = {0.5, 2};
    anchors_.pairs = {{"chin", Vector3::Zero(), Vector3::Zero()}, {"heel", Vector3::Ones(), Vector3::Ones()}};
  }
  std::string text() const {
    const Problem input{mesh_, mesh_, anchors_};
    return fit_text({input, made_, "a.obj", "b.obj", "ab.vdb", "", 2'500'000, 3.25, "bespoke view ab.vdb"});
  }

  TriangleMesh mesh_ = shapes::icosphere(2);
  Anchors anchors_;
  std::shared_ptr<FittedMapping> fit_ = std::make_shared<FittedMapping>();
  MadeMap made_;
};

TEST_F(FitText, SaysWhatAnEngineerAsks) {
  const std::string lines = text();
  for (const char* line :
       {"registered   a.obj (162 vertices) to b.obj (162 vertices), by 2 anchors\n",
        "surfaces     half of the registered source lies within 0.25 dm of the target, 95 % within 0.75 dm",
        "counterparts every vertex has one", "half are met within 0.5 dm, all within 2 dm (\"heel\")",
        "proved       the map is one-to-one", "within 0.0005 dm of the exact one; tolerance",
        "written      ab.vdb, 2.5 MB, in 3.2 s\n", "next         bespoke view ab.vdb\n"})
    EXPECT_THAT(lines, HasSubstr(line));
  EXPECT_THAT(lines, Not(HasSubstr("MISSED")));
}

// The diagonal is 3.5.
TEST_F(FitText, ToldLengthsAreNoShorterThanAnybodyMeasures) {
  fit_->summary.surface->after = summarize({0.0, 5e-15, 0.02});
  EXPECT_THAT(text(),
              HasSubstr("lies within 1e-05 dm of the target, 95 % within 0.02 dm, all within 0.02 dm"));
  Eigen::Index side = 0;
  mesh_.vertices.row(0).maxCoeff(&side);
  mesh_.vertices.col(side) = Vector3(1, 3e-17, -2e-16);
  fit_->confidence[static_cast<std::size_t>(side)] = 0;
  EXPECT_THAT(text(),
              HasSubstr("1 of 162 vertices have none and follow their surroundings: 1 around (1, 0, 0)"));
}

TEST_F(FitText, SaysThatTheFittedMapIsStoredAsItIs) {
  fit_->summary.bake->error = summarize({0.0});
  EXPECT_THAT(text(), HasSubstr("error        the stored map is the fitted one; "));
}

TEST_F(FitText, SaysHowMuchAMapThatIsProvedSqueezes) {
  EXPECT_THAT(text(), Not(HasSubstr("volumes shrink")));
  Certificate& certificate = made_.asset.steps.front().certificate;
  certificate.min_determinant = certificate.affine_determinant / 400;
  EXPECT_THAT(text(), HasSubstr("folds nowhere; where it is tightest volumes shrink 400 times"));
}

TEST_F(FitText, SaysFirstThatAMapIsNotProved) {
  Certificate& certificate = made_.asset.steps.front().certificate;
  certificate.folded = 202;
  EXPECT_THAT(text(), StartsWith("NOT PROVED "));
  EXPECT_THAT(text(), HasSubstr("202 cells fold"));
  EXPECT_THAT(text(), Not(HasSubstr("\nproved ")));
}

// Two vertices at one pole, none of them a neighbour of the one at the other.
TEST_F(FitText, SaysWhereVerticesHaveNoCounterpart) {
  Eigen::Index top = 0, bottom = 0;
  mesh_.vertices.row(1).maxCoeff(&top);
  mesh_.vertices.row(1).minCoeff(&bottom);
  for (const auto& face : mesh_.faces.colwise())
    if ((face.array() == static_cast<int>(top)).any())
      for (const int vertex : face) fit_->confidence[static_cast<std::size_t>(vertex)] = 0;
  fit_->confidence[static_cast<std::size_t>(bottom)] = 0;
  const auto around_top = std::count(fit_->confidence.begin(), fit_->confidence.end(), 0.0) - 1;
  EXPECT_THAT(text(), HasSubstr(std::to_string(around_top + 1) + " of 162 vertices have none"));
  EXPECT_THAT(text(), HasSubstr(": " + std::to_string(around_top) + " around ("));
  EXPECT_THAT(text(), HasSubstr(", 1 around ("));
}

TEST_F(FitText, HasAtMostTenLines) {
  made_.asset.steps.front().certificate.folded = 1;
  fit_->summary.bake->tolerance_met = false;
  fit_->summary.uncovered.emplace();
  fit_->summary.uncovered->share = 0.5;
  fit_->confidence.assign(fit_->confidence.size(), 0);
  const std::string lines = text();
  EXPECT_LE(std::count(lines.begin(), lines.end(), '\n'), 10);
  EXPECT_THAT(lines, HasSubstr(" MISSED"));
  EXPECT_THAT(lines, HasSubstr("50.0 % of the target is uncovered"));
}

TEST_F(FitText, NamesNoUnitThatIsNotKnown) {
  made_.asset.record.unit = "unknown";
  EXPECT_THAT(text(), HasSubstr("0.25 mesh units of the target"));
}

}  // namespace
}  // namespace bespoke
