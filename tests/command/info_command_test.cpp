#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

TEST(InfoCommand, SaysWhatTheAssetHolds) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const ProgramResult text = bespoke({"info", pair.file("map.vdb")});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  for (const char* part :
       {"unit cm", "stored       as fitted", "certificate", "voxel size", "anchors      14"})
    EXPECT_THAT(text.out, HasSubstr(part));

  const ProgramResult result = bespoke({"info", pair.file("map.vdb"), "--json", "--untrusted"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const auto printed = nlohmann::json::parse(result.out);
  for (const char* key : {"rotation", "translation", "affine_linear", "affine_offset", "certificate",
                          "options", "stages", "source", "target", "anchors", "bake_error", "levels"})
    EXPECT_TRUE(printed.contains(key)) << key;
  EXPECT_EQ(printed["unit"], "cm");
  const auto& certificate = printed["certificate"];
  EXPECT_EQ(certificate["bijection"].get<bool>(), certificate["folded"] == 0 &&
                                                      certificate["undecided"] == 0 &&
                                                      certificate["affine_determinant"] > 0);
}

TEST(InfoCommand, RefusesWhatIsNotAnAsset) {
  const ExamplePair pair;
  const ProgramResult mesh = bespoke({"info", pair.file("source.obj")});
  EXPECT_EQ(mesh.exit_code, 2);
  EXPECT_THAT(mesh.err, HasSubstr("source.obj"));
  const ProgramResult missing = bespoke({"info", pair.file("none.vdb")});
  EXPECT_EQ(missing.exit_code, 4);
  EXPECT_THAT(missing.err, HasSubstr("none.vdb"));
  EXPECT_EQ(bespoke({"info"}).exit_code, 1);
}

}  // namespace
}  // namespace bespoke::test
