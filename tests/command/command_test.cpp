#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

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

TEST(Command, ListsAllSubcommandsInGroups) {
  const std::string help = bespoke({"--help"}).out;
  const char* before = "Usage:";
  for (const char* part : {"\nMake a map:\n", "\n  fit ", "\nUse it:\n", "\n  apply ", "\nLook at it:\n",
                           "\n  view ", "\nMany maps and products:\n", "\n  batch ",
                           "\nExchange with other programs:\n", "\n  export ", "\nExit codes"}) {
    ASSERT_THAT(help, HasSubstr(part));
    EXPECT_LT(help.find(before), help.find(part)) << part;
    before = part;
  }
}

/// The subcommands that a help lists, as completion finds them.
std::vector<std::string> listed_subcommands(const std::string& help) {
  std::vector<std::string> names;
  std::istringstream lines(help);
  std::smatch match;
  for (std::string line; std::getline(lines, line);)
    if (std::regex_match(line, match, std::regex("  ([a-z]+)  .*"))) names.push_back(match[1]);
  return names;
}

TEST(Command, HelpFitsATerminal) {
  std::vector<std::vector<std::string>> commands{
      {}, {"anchors", "convert"}, {"anchors", "audit"}, {"anchors", "suggest"}, {"fit", "-h"}};
  for (const std::string& name : listed_subcommands(bespoke({"--help"}).out)) commands.push_back({name});
  EXPECT_EQ(commands.size(), 5u + 18u);
  for (std::vector<std::string> command : commands) {
    if (command.empty() || command.back() != "-h") command.push_back("--help");
    const ProgramResult help = bespoke(command);
    EXPECT_EQ(help.exit_code, 0);
    std::istringstream lines(help.out);
    for (std::string line; std::getline(lines, line);) {
      const auto columns = std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
      // Examples stay on one line, to be copied.
      if (line.starts_with("  bespoke ") || line.starts_with("  {")) continue;
      EXPECT_LE(columns, 80) << line;
    }
  }
}

TEST(Command, ShortHelpOfFitHasSomeOfTheOptionsOfTheLong) {
  const auto options = [](const std::string& help) {
    const std::regex option("\n  (-[a-z],)?(--[a-z-]+)");
    return std::distance(std::sregex_iterator(help.begin(), help.end(), option), std::sregex_iterator());
  };
  const std::string brief = bespoke({"fit", "-h"}).out, full = bespoke({"fit", "--help"}).out;
  EXPECT_GE(options(brief), 10);
  EXPECT_LE(options(brief), 16);
  EXPECT_GT(options(full), 2 * options(brief));
  EXPECT_THAT(brief, HasSubstr("`bespoke fit --help` has all"));
  for (const char* group : {"\nInput:\n", "\nOutput:\n", "\nQuality:\n", "\nMany jobs:\n"}) {
    EXPECT_THAT(brief, HasSubstr(group));
    EXPECT_THAT(full, HasSubstr(group));
  }
  EXPECT_THAT(full, HasSubstr("\nMethod:\n"));
}

}  // namespace
}  // namespace bespoke::test
