#include "bespoke/catalog/record_difference.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "asset/small_asset.h"

namespace bespoke {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;

auto field(const std::string& name, const std::string& a, const std::string& b) {
  return ::testing::AllOf(Field(&FieldDifference::name, name), Field(&FieldDifference::a, a),
                          Field(&FieldDifference::b, b));
}

TEST(RecordDifference, OfAnAssetFromItselfIsEmpty) {
  const Asset asset = test::small_asset();
  EXPECT_TRUE(record_difference(asset, asset).is_empty());
}

TEST(RecordDifference, NamesFieldsAndOptionsThatDiffer) {
  Asset a = test::small_asset(), b = a;
  a.record.tolerance = 0.5;
  b.record.tolerance = 0.25;
  a.record.options_json = R"({"tolerance": 0.5, "fit": {"steps": 3, "only": true}, "list": [1, 2]})";
  b.record.options_json = R"({"tolerance": 0.25, "fit": {"steps": 4}, "list": [1, 2], "more": "x"})";
  b.record.bake_error.max *= 2;  // was found, not requested
  EXPECT_THAT(record_difference(a, b).fields,
              ElementsAre(field("tolerance", "0.5", "0.25"), field("options.fit.steps", "3", "4"),
                          field("options.fit.only", "true", ""), field("options.more", "", "\"x\"")));
}

TEST(RecordDifference, NamesAnchorsThatMovedCameOrWent) {
  Asset a = test::small_asset(), b = a;
  AnchorRecord anchor{"chin", {1, 0, 0}, {2, 0, 0}, std::numeric_limits<double>::infinity(), 0, 0};
  a.record.anchors = b.record.anchors = {anchor, anchor, anchor, anchor};
  for (Asset* asset : {&a, &b}) {
    asset->record.anchors[1].name = "ear";
    asset->record.anchors[2].name = "nose";
    asset->record.anchors[3].name = "";
  }
  b.record.anchors[0].b = Vector3(2, 3, 4);
  b.record.anchors[1].name = "left ear";
  b.record.anchors[2].sigma = 0.1;
  b.record.anchors[3].a = Vector3(1, 0, 1);
  const std::vector<AnchorDifference> found = record_difference(a, b).anchors;
  ASSERT_EQ(found.size(), 5u);  // by name
  EXPECT_EQ(found[0].name, "4");
  EXPECT_EQ(found[0].moved_source, 1);
  EXPECT_EQ(found[1].name, "chin");
  EXPECT_EQ(found[1].moved_target, 5);
  EXPECT_TRUE(found[2].in_a && !found[2].in_b);
  EXPECT_TRUE(!found[3].in_a && found[3].in_b);
  EXPECT_TRUE(found[4].other_accuracy);
}

}  // namespace
}  // namespace bespoke
