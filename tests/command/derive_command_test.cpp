#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

nlohmann::json info(const ExamplePair& pair, const std::string& map) {
  return nlohmann::json::parse(bespoke({"info", pair.file(map), "--json"}).out);
}

double tolerance(const ExamplePair& pair, const std::string& map) { return info(pair, map)["tolerance"]; }

TEST(CheckCommand, ProvesTheBijectionFromTheFileAloneAtAnyTime) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb", {"--require-certified"}).exit_code, 0);
  const ProgramResult text = bespoke({"check", pair.file("map.vdb"), "--quiet"});
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("a bijection of space"));
  const ProgramResult printed =
      bespoke({"check", pair.file("map.vdb"), "--t", "0.5", "--json", "--untrusted"});
  EXPECT_EQ(printed.exit_code, 0) << printed.err;
  EXPECT_TRUE(nlohmann::json::parse(printed.out)["bijection"]);
  // Far beyond the map the motion turns space over.
  const ProgramResult beyond = bespoke({"check", pair.file("map.vdb"), "--t", "-20"});
  EXPECT_EQ(beyond.exit_code, 3) << beyond.out;
  EXPECT_THAT(beyond.err, HasSubstr("not proved"));
  EXPECT_EQ(bespoke({"check", pair.file("none.vdb")}).exit_code, 4);
  EXPECT_EQ(bespoke({"check", pair.file("source.obj")}).exit_code, 2);
}

TEST(InvertCommand, LeadsBackAsTheCellsOfTheMapDo) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  ASSERT_EQ(pair.apply("map.vdb", {"-o", pair.file("there.obj")}).exit_code, 0);
  const ProgramResult inverted =
      bespoke({"invert", pair.file("map.vdb"), "-o", pair.file("back.vdb"), "--tolerance", "0.05%"});
  ASSERT_EQ(inverted.exit_code, 0) << inverted.err;
  EXPECT_THAT(inverted.out, HasSubstr("round trip"));
  EXPECT_EQ(bespoke({"check", pair.file("back.vdb")}).exit_code, 0);
  const Points product = read_obj_points(pair.file("product.obj"));
  const auto moved = [&](const char* name) {
    return (read_obj_points(pair.file(name)) - product).colwise().norm().maxCoeff();
  };
  // Float files add their rounding: once for what goes in, a few times more where the inverse stretches.
  const double rounding = 10 * float_rounding(product);

  const ProgramResult cells = bespoke(
      {"apply", pair.file("map.vdb"), pair.file("there.obj"), "--inverse", "-o", pair.file("cells.obj")});
  ASSERT_EQ(cells.exit_code, 0) << cells.err;
  EXPECT_LT(moved("cells.obj"),
            1e-3 * info(pair, "map.vdb")["levels"].back()["voxel_size"].get<double>() + rounding);

  ASSERT_EQ(bespoke({"apply", pair.file("back.vdb"), pair.file("there.obj"), "-o", pair.file("baked.obj")})
                .exit_code,
            0);
  EXPECT_LT(moved("baked.obj"), tolerance(pair, "map.vdb") + tolerance(pair, "back.vdb") + rounding);
}

TEST(ComposeCommand, JoinsMapsWhoseModelsMeet) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  ASSERT_EQ(bespoke({"invert", pair.file("map.vdb"), "-o", pair.file("back.vdb")}).exit_code, 0);
  const ProgramResult joined =
      bespoke({"compose", pair.file("map.vdb"), pair.file("back.vdb"), "-o", pair.file("round.vdb")});
  ASSERT_EQ(joined.exit_code, 0) << joined.err;
  ASSERT_EQ(pair.apply("round.vdb", {"-o", pair.file("same.obj")}).exit_code, 0);
  const Points product = read_obj_points(pair.file("product.obj"));
  EXPECT_LT((read_obj_points(pair.file("same.obj")) - product).colwise().norm().maxCoeff(),
            tolerance(pair, "round.vdb") + tolerance(pair, "back.vdb") + 10 * float_rounding(product));

  const ProgramResult apart =
      bespoke({"compose", pair.file("map.vdb"), pair.file("map.vdb"), "-o", pair.file("x.vdb")});
  EXPECT_EQ(apart.exit_code, 2);
  EXPECT_THAT(apart.err, HasSubstr("another model"));
  EXPECT_FALSE(pair.has("x.vdb"));
  EXPECT_EQ(bespoke({"compose", pair.file("map.vdb"), pair.file("map.vdb"), "-o", pair.file("x.vdb"),
                     "--any-models"})
                .exit_code,
            0);
}

TEST(DerivedMaps, TakeATheirToleranceAndCheckWhatTheyReadInAChild) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto run = [&](std::vector<std::string> arguments, const std::vector<std::string>& extra) {
    arguments.insert(arguments.end(), {"--untrusted", "-q"});
    arguments.insert(arguments.end(), extra.begin(), extra.end());
    const ProgramResult result = bespoke(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
  };
  const std::vector<std::string> invert{"invert", pair.file("map.vdb"), "-o", pair.file("back.vdb")};
  const std::vector<std::string> compose{"compose", pair.file("map.vdb"), pair.file("back.vdb"), "-o",
                                         pair.file("round.vdb")};
  run(invert, {});
  EXPECT_EQ(tolerance(pair, "back.vdb"), tolerance(pair, "map.vdb"));
  run(compose, {});
  EXPECT_EQ(tolerance(pair, "round.vdb"), tolerance(pair, "map.vdb"));
  // In mesh units, and in percent of the diagonal of the model that the map starts from.
  run(invert, {"--tolerance", "0.03"});
  EXPECT_EQ(tolerance(pair, "back.vdb"), 0.03);
  run(compose, {"--tolerance", "1%"});
  const Points source = read_obj_points(pair.file("source.obj"));
  EXPECT_NEAR(tolerance(pair, "round.vdb"), 0.01 * extent(source), 0.01 * 2 * float_rounding(source));
  for (std::vector<std::string> arguments : {invert, compose}) {
    arguments.insert(arguments.end(), {"--tolerance", "-1"});
    EXPECT_EQ(bespoke(arguments).exit_code, 1);
  }
}

TEST(DerivedMaps, RefuseWhatTheyCannotRead) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const auto refused = [&](const std::vector<std::string>& arguments, int exit_code, const char* text) {
    const ProgramResult result = bespoke(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_THAT(result.err, HasSubstr(text));
    EXPECT_FALSE(pair.has("x.vdb"));
  };
  const std::string map = pair.file("map.vdb"), out = pair.file("x.vdb");
  for (const char* mode : {"-q", "--untrusted"}) {
    refused({"invert", pair.file("source.obj"), "-o", out, mode}, 2, "source.obj");
    refused({"compose", map, pair.file("source.obj"), "-o", out, mode}, 2, "source.obj");
  }
  refused({"invert", pair.file("none.vdb"), "-o", out}, 4, "none.vdb");
  refused({"compose", pair.file("none.vdb"), map, "-o", out}, 4, "none.vdb");
  refused({"invert", map, "-o", map}, 1, "overwritten");
  refused({"compose", map, map, "-o", map}, 1, "overwritten");
  refused({"invert", map, "-o", pair.file("none/x.vdb")}, 4, "none");
  refused({"invert", map, "-o", pair.file("x.obj")}, 1, "x.obj must end in .vdb");
  refused({"compose", map, map, "-o", pair.file("x")}, 1, "must end in .vdb");
  EXPECT_FALSE(pair.has("x.obj"));
  refused({"invert", map}, 1, "--output");
  refused({"compose", map}, 1, "BC");
}

TEST(CheckCommand, TakesAnyFiniteTime) {
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  for (const std::string t : {"nan", "inf", "half"}) {
    const ProgramResult result = bespoke({"check", pair.file("map.vdb"), "--t", t});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, HasSubstr("'" + t + "' is not a finite number"));
  }
}

// One vertex pulled far through its neighbours folds the space around it, in one step, and one uniform level
// repairs nothing.
TEST(UncertifiedMap, IsWrittenOnlyUnlessACertificateIsRequiredAndHasNoInverse) {
  const ExamplePair pair;
  const double length = extent(read_obj_points(pair.file("source.obj")));
  std::ifstream lines(pair.file("source.obj"));
  std::ofstream pulled(pair.file("pulled.obj"));
  bool first = true;
  for (std::string line; std::getline(lines, line);) {
    double x = 0, y = 0, z = 0;
    if (first && std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) {
      first = false;
      pulled << "v " << x + 0.3 * length << ' ' << y << ' ' << z << '\n';
    } else {
      pulled << line << '\n';
    }
  }
  pulled.close();
  std::vector<std::string> fit{
      "fit", pair.file("source.obj"), pair.file("target.obj"), "--fitted", pair.file("pulled.obj"),
      "-o",  pair.file("map.vdb")};
  for (const char* word : {"--elastic", "csrbf", "--steps", "1", "--voxel-size", "1%", "--require-certified"})
    fit.emplace_back(word);
  const ProgramResult result = bespoke(fit);
  EXPECT_EQ(result.exit_code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("not certified"));
  EXPECT_FALSE(pair.has("map.vdb"));

  fit.pop_back();
  const ProgramResult unproved = bespoke(fit);
  ASSERT_EQ(unproved.exit_code, 0);
  const std::size_t first_warning = unproved.err.find("bespoke: warning: ");
  EXPECT_EQ(unproved.err.find("bespoke: warning: the map is not proved to be one-to-one"), first_warning)
      << unproved.err;
  EXPECT_NE(first_warning, std::string::npos);
  EXPECT_THAT(unproved.out, testing::StartsWith("NOT PROVED"));
  const ProgramResult check = bespoke({"check", pair.file("map.vdb")});
  EXPECT_EQ(check.exit_code, 3);
  EXPECT_THAT(check.err, HasSubstr("map.vdb: not proved to be one-to-one"));
  EXPECT_THAT(check.out, testing::StartsWith("NOT PROVED"));
  EXPECT_THAT(check.out, HasSubstr("  level 0 at "));  // where it folds
  EXPECT_FALSE(nlohmann::json::parse(bespoke({"check", pair.file("map.vdb"), "--json"}).out)["bijection"]);
  const ProgramResult invert = bespoke({"invert", pair.file("map.vdb"), "-o", pair.file("back.vdb")});
  EXPECT_EQ(invert.exit_code, 2);
  EXPECT_THAT(invert.err, HasSubstr("not certified as a bijection"));
  const ProgramResult apply = pair.apply("map.vdb", {"--inverse", "-o", pair.file("out.obj")});
  EXPECT_EQ(apply.exit_code, 2);
  EXPECT_THAT(apply.err, HasSubstr("map.vdb: is not certified as a bijection, so it has no inverse"));
  EXPECT_FALSE(pair.has("back.vdb") || pair.has("out.obj"));
}

}  // namespace
}  // namespace bespoke::test
