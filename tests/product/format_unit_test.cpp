#include "bespoke/product/format_unit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string refusal(const std::string& model, const std::string& unit) {
  return test::error_message<InvalidInput>([&] { require_unit_of_format(model, unit); });
}

TEST(FormatUnit, OfGltfIsTheMetre) {
  EXPECT_EQ(unit_of_format("scan.GLB"), "m");
  EXPECT_EQ(unit_of_format("scan.gltf"), "m");
  EXPECT_EQ(unit_of_format("scan.obj"), "");
}

TEST(FormatUnit, KnowsUnitsByTheirNames) {
  EXPECT_EQ(metres_per_unit("mm"), 0.001);
  EXPECT_EQ(metres_per_unit("CM"), 0.01);
  EXPECT_EQ(metres_per_unit("metres"), 1);
  EXPECT_EQ(metres_per_unit("cubit"), std::nullopt);
  EXPECT_EQ(metres_per_unit(""), std::nullopt);
}

TEST(FormatUnit, ConvertsBetweenUnitsExactlyBackAndForth) {
  EXPECT_EQ(unit_factor("m", "cm"), 100);
  EXPECT_EQ(unit_factor("cm", "m"), 0.01);
  EXPECT_EQ(unit_factor("in", "mm"), 25.4);
  EXPECT_EQ(unit_factor("ft", "inches"), 12);
  EXPECT_EQ(unit_factor("Metres", "m"), 1);
  EXPECT_EQ(unit_factor("ells", "ells"), 1);
  EXPECT_EQ(unit_factor("ells", "m"), std::nullopt);
  EXPECT_EQ(unit_factor("", "m"), std::nullopt);
  EXPECT_THAT(test::error_message<InvalidInput>([] { required_unit_factor("ells", "m"); }),
              HasSubstr("the unit \"ells\" is not known"));
}

TEST(FormatUnit, OfAProductIsTheUsersTheFilesOrTheMaps) {
  EXPECT_EQ(product_scale("a.glb", "cm"), 100);
  EXPECT_EQ(product_scale("a.glb", "cm", "mm"), 0.1);
  EXPECT_EQ(product_scale("a.glb", "cm", "map"), 1);
  EXPECT_EQ(product_scale("a.obj", "cm"), 1);
  EXPECT_EQ(product_scale("a.obj", "cm", "in"), 2.54);
  EXPECT_EQ(product_scale("a.glb", "unknown"), 1);
  EXPECT_THAT(test::error_message<InvalidInput>([] { product_scale("a.obj", "unknown", "mm"); }),
              HasSubstr("nothing is converted from \"mm\" to \"unknown\""));
  EXPECT_EQ(product_unit("a.glb", "cm"), "m");
  EXPECT_EQ(product_unit("a.obj", "cm"), "cm");
  EXPECT_EQ(product_unit("a.obj", "unknown"), "");
  EXPECT_EQ(product_unit("a.glb", "cm", "map"), "cm");
}

TEST(FormatUnit, RefusesAnotherOneByItsFactor) {
  EXPECT_THAT(refusal("scan.glb", "cm"),
              AllOf(HasSubstr("scan.glb"), HasSubstr("in cm"), HasSubstr("by 0.01 ")));
  EXPECT_THAT(refusal("scan.glb", "Inch"), HasSubstr("by 0.0254 "));
  EXPECT_THAT(refusal("scan.glb", "ells"), HasSubstr("the anchors are in ells"));
  for (const char* unit : {"", "m", "Metres"}) EXPECT_EQ(refusal("scan.glb", unit), "accepted") << unit;
  EXPECT_EQ(refusal("scan.obj", "cm"), "accepted");
}

}  // namespace
}  // namespace bespoke
