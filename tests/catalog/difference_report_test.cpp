#include "bespoke/catalog/difference_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asset/small_asset.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class DifferenceReport : public ::testing::Test {
 protected:
  DifferenceReport() {
    a_.record.anchors = {{"chin", {1, 0, 0}, {2, 0, 0}, 1, 0, 0}, {"ear", {5, 0, 0}, {6, 0, 0}, 1, 0, 0}};
    b_ = a_;
    b_.record.tolerance = 2 * a_.record.tolerance;
    b_.target_from_source.translation += Vector3(0, 3, 0);
  }
  ComparedMaps compared() const {
    return {a_, b_, map_difference(a_, b_, {Vector3(1, 0, 2)}), record_difference(a_, b_), {"dress.obj"}};
  }

  Asset a_ = test::small_asset();
  Asset b_;
};

TEST_F(DifferenceReport, SaysHowFarWhereAndWhatElse) {
  EXPECT_THAT(difference_text(compared()),
              AllOf(HasSubstr("max 3 "), HasSubstr("dress.obj  min 3"), HasSubstr("at (1, 0, 2)"),
                    HasSubstr("2 from anchor \"chin\""), HasSubstr("\n  tolerance: "),
                    HasSubstr("affine parts at most 3 apart")));
}

TEST_F(DifferenceReport, OfOneMapSaysSo) {
  b_ = a_;
  EXPECT_THAT(difference_text(compared()),
              AllOf(HasSubstr("max 0 "), HasSubstr("records      the same"), Not(HasSubstr("largest"))));
}

TEST_F(DifferenceReport, HasTheSameNumbersAsJson) {
  const nlohmann::json json = nlohmann::json::parse(difference_json(compared()));
  EXPECT_NEAR(json["distance"]["max"], 3, 1e-12);
  EXPECT_NEAR(json["affine_distance"], 3, 1e-12);
  EXPECT_EQ(json["products"][0]["name"], "dress.obj");
  EXPECT_EQ(json["products"][0]["largest"]["at"], nlohmann::json({1, 0, 2}));
  EXPECT_EQ(json["products"][0]["largest"]["nearest_anchor"], "chin");
  EXPECT_EQ(json["records"]["fields"][0]["name"], "tolerance");
  EXPECT_EQ(json["records"]["fields"][0]["b"], b_.record.tolerance);
  EXPECT_EQ(json["a"]["bijection"], whole_certificate(a_).is_bijection());
}

}  // namespace
}  // namespace bespoke
