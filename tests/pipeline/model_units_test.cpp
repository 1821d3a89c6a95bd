#include "bespoke/pipeline/model_units.h"

#include <gmock/gmock.h>

#include "bespoke/error.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

Anchors anchors_in(const std::string& unit) {
  Anchors anchors;
  anchors.unit = unit;
  anchors.pairs = {{"p", Vector3(1, 0, 0), Vector3(0, 1, 0)}};
  return anchors;
}

TEST(ModelUnits, AreThoseOfTheFirstThatSaysOne) {
  Anchors none = anchors_in("");
  EXPECT_EQ(bring_to_one_unit({}, none).unit, "");
  const UnitPlan plan = bring_to_one_unit({"", "in", "mm"}, none);
  EXPECT_EQ(plan.unit, "in");
  EXPECT_EQ(plan.source_scale, 1);
  EXPECT_DOUBLE_EQ(plan.target_scale, 1 / 25.4);
  // Anchors without a unit are in the coordinates of their models' files.
  EXPECT_EQ(none.pairs[0].a, Vector3(1, 0, 0));
  EXPECT_DOUBLE_EQ(none.pairs[0].b[1], 1 / 25.4);
  EXPECT_EQ(none.unit, "in");
}

TEST(ModelUnits, AreConvertedToTheOneThatIsAskedFor) {
  Anchors centimetres = anchors_in("cm");
  const UnitPlan plan = bring_to_one_unit({"mm", "m", ""}, centimetres);
  EXPECT_EQ(plan.unit, "mm");
  EXPECT_EQ(plan.source_scale, 1000);
  EXPECT_EQ(plan.target_scale, 1);
  EXPECT_EQ(centimetres.pairs[0].a, Vector3(10, 0, 0));
  EXPECT_EQ(centimetres.pairs[0].b, Vector3(0, 10, 0));
  Anchors none = anchors_in("");
  EXPECT_EQ(bring_to_one_unit({"ells", "", ""}, none).unit, "ells");
}

TEST(ModelUnits, AreRefusedWhereNobodyAsksForOne) {
  const auto refusal = [](const ModelUnits& units, const std::string& of_anchors) {
    Anchors anchors = anchors_in(of_anchors);
    return test::error_message<InvalidInput>([&] { bring_to_one_unit(units, anchors); });
  };
  EXPECT_THAT(refusal({"", "m", "", "a.glb"}, "cm"),
              HasSubstr("a.glb: is in metres, as every glTF file, but the anchors are in cm"));
  EXPECT_THAT(refusal({"", "", "in"}, "mm"), HasSubstr("target: is in in"));
  EXPECT_EQ(refusal({"", "m", "m"}, "Metres"), "accepted");
  EXPECT_THAT(refusal({"ells", "m", ""}, ""), HasSubstr("the unit \"ells\" is not known"));
}

}  // namespace
}  // namespace bespoke
