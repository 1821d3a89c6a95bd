#include "bespoke/report/inspection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "asset/small_asset.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(InspectionText, SaysWhatTheAssetHolds) {
  const Asset asset = test::small_asset();
  const std::string text = inspection_text(asset);
  for (const std::string& part :
       {std::string("maps points a to b"), std::string("unit dm"), std::string("csrbf"),
        std::string("laplacian"), std::string("translation  (0.5, -0.25, 0.333333)"),
        std::string("1536 voxels in 3 leaves"), std::string("1024 voxels in 2 leaves"),
        std::string("max 0.0005"), asset.record.source.hash, asset.record.target.hash,
        std::string("not stored")})
    EXPECT_THAT(text, HasSubstr(part));
}

TEST(InspectionText, ListsEveryAnchorWithItsResidual) {
  const std::string text = inspection_text(test::small_asset());
  EXPECT_THAT(text, HasSubstr("anchors      2\n"));
  EXPECT_THAT(text, testing::ContainsRegex("nose .tip. .*  +1\\.5  +0\\.01\n"));
  EXPECT_THAT(text, testing::ContainsRegex("-  +exact  +0\n"));
}

TEST(InspectionText, SaysWhyTheMapIsABijection) {
  Asset asset = test::small_asset();
  EXPECT_THAT(inspection_text(asset), HasSubstr("proved to be a bijection of all of space"));
  EXPECT_THAT(inspection_text(asset), HasSubstr("at least 0.0625 in all 12345"));
  asset.steps.front().certificate.undecided = 1;
  // What matters most comes first.
  EXPECT_THAT(inspection_text(asset), testing::StartsWith("certificate  NOT PROVED to be one-to-one"));
  EXPECT_THAT(inspection_text(asset), HasSubstr("(0.1, 0.2, 0.3)"));
  EXPECT_THAT(inspection_text(asset), Not(HasSubstr("homeomorphism")));
}

TEST(InspectionJson, HoldsTheSameNumbers) {
  const Asset asset = test::small_asset();
  const auto json = nlohmann::json::parse(inspection_json(asset));
  EXPECT_EQ(json["direction"], "maps points a to b");
  EXPECT_EQ(json["translation"][2], 1.0 / 3);
  EXPECT_EQ(json["levels"].size(), 2u);
  EXPECT_EQ(json["levels"][1]["voxel_size"], asset.steps.front().pyramid.levels[1].voxel_size);
  EXPECT_EQ(json["anchors"][0]["residual"], 0.01);
  EXPECT_EQ(json["options"]["lambda"], "10%");
}

TEST(InspectionJson, OfARecordWithoutOptionsIsStillJson) {
  Asset asset = test::small_asset();
  asset.record.options_json.clear();
  asset.record.stages_json.clear();
  asset.record.anchors.clear();
  EXPECT_TRUE(nlohmann::json::parse(inspection_json(asset))["options"].is_null());
}

}  // namespace
}  // namespace bespoke
