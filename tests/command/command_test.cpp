#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

TEST(Command, NeedsASubcommand) {
  EXPECT_EQ(bespoke({}).exit_code, 1);
  EXPECT_EQ(bespoke({"knit"}).exit_code, 1);
  const ProgramResult option = bespoke({"info", "map.vdb", "--colour"});
  EXPECT_EQ(option.exit_code, 1);
  EXPECT_THAT(option.err, StartsWith("bespoke: "));
  EXPECT_THAT(option.err, HasSubstr("--colour"));
}

TEST(Command, PointsToTheHelpOfWhatWasMeant) {
  EXPECT_THAT(bespoke({"knit"}).err, HasSubstr("'knit'; see bespoke --help"));
  EXPECT_THAT(bespoke({"info", "map.vdb", "--colour"}).err, HasSubstr("see bespoke info --help"));
  EXPECT_THAT(bespoke({"anchors", "audit", "a", "b", "c"}).err,
              HasSubstr("see bespoke anchors audit --help"));
}

TEST(Command, SaysItsVersion) {
  const ProgramResult version = bespoke({"--version"});
  EXPECT_EQ(version.exit_code, 0);
  EXPECT_EQ(version.out, BESPOKE_VERSION "\n");
  const auto versions = nlohmann::json::parse(bespoke({"--version", "--json"}).out);
  EXPECT_EQ(versions["bespoke"], BESPOKE_VERSION);
  for (const char* library :
       {"openvdb", "tbb", "eigen", "openssl", "zlib", "expat", "nlohmann_json", "cli11"})
    EXPECT_THAT(versions[library].get<std::string>(), testing::ContainsRegex("[0-9]+\\.[0-9]+")) << library;
}

TEST(Command, ExplainsItselfWithExamples) {
  EXPECT_THAT(bespoke({"--help"}).out, HasSubstr("Exit codes"));
  for (const std::string name :
       {"fit", "apply", "info", "check", "invert", "compose", "measure", "batch", "samples"}) {
    const ProgramResult help = bespoke({name, "--help"});
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_THAT(help.out, HasSubstr("Examples:\n  bespoke " + name));
  }
}

}  // namespace
}  // namespace bespoke::test
