#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <string>
#include <vector>

#include "bespoke/product/mesh_io.h"
#include "command/fit_command.h"
#include "support/shapes.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;
using testing::Not;

using FitRefusals = FitCommand;

TEST_F(FitRefusals, SaysThatModelsWithoutAnchorsCannotBeAligned) {
  write_triangle_mesh(pair_.file("ball.obj"), shapes::icosphere(3));
  write_triangle_mesh(pair_.file("other_ball.obj"), shapes::icosphere(2));
  expect_refusal(
      bespoke({"fit", pair_.file("ball.obj"), pair_.file("other_ball.obj"), "-o", pair_.file("map.vdb")}), 3,
      "give at least 4 anchors");
}

TEST_F(FitRefusals, NeedsAnchorsForWhatIsMadeOfThem) {
  expect_refusal(bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "-o",
                          pair_.file("map.vdb"), "--paper"}),
                 1, "--paper");
  expect_refusal(bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "-o",
                          pair_.file("map.vdb"), "--fitted", pair_.file("source.obj"), "--add-corners"}),
                 1, "--add-corners");
}

TEST_F(FitRefusals, TakesNothingOfTheSurfaceFittingWhereThatIsSkipped) {
  const std::vector<std::vector<std::string>> options = {{"--confidence-out", pair_.file("confidence.txt")},
                                                         {"--surface-fit", "laplacian"},
                                                         {"--boundaries", "free"},
                                                         {"--max-stretch", "3"},
                                                         {"--as-given"}};
  for (std::vector<std::string> option : options) {
    const std::string name = option.front();
    option.insert(option.end(), {"--fitted", pair_.file("source.obj")});
    expect_refusal(pair_.fit("map.vdb", option), 1, name);
  }
}

TEST_F(FitRefusals, TakesNothingThatTheMethodsDoNotKnow) {
  const std::vector<std::vector<std::string>> options = {
      {"--guides", "all", "--elastic", "csrbf"},
      {"--guides", "steps", "--paper"},
      {"--nodes", "balanced", "--voxel-size", "5%"},
      {"--boundaries", "free", "--surface-fit", "laplacian"},
      {"--max-stretch", "3", "--paper"},
      {"--elastic", "pffd", "--paper"},
      {"--surface-fit", "laplacian", "--paper"},
      {"--path", "flow", "--paper"}};
  for (const std::vector<std::string>& option : options)
    expect_refusal(pair_.fit("map.vdb", option), 1, option.front());
  EXPECT_EQ(pair_.fit("map.vdb", {"--guides", "none", "--elastic", "pffd-smooth"}).exit_code, 0);
}

TEST_F(FitRefusals, NeedsItsPositionalArguments) {
  EXPECT_EQ(bespoke({"fit"}).exit_code, 1);
  EXPECT_EQ(bespoke({"fit", pair_.file("source.obj")}).exit_code, 1);
  const ProgramResult no_output = bespoke(
      {"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors", pair_.file("anchors.json")});
  EXPECT_EQ(no_output.exit_code, 1);
  EXPECT_THAT(no_output.err, HasSubstr("--output"));
}

TEST_F(FitRefusals, NamesTheMethodItDoesNotKnow) {
  expect_refusal(pair_.fit("map.vdb", {"--elastic", "spline"}), 1, "spline");
  expect_refusal(pair_.fit("map.vdb", {"--surface-fit", "glue"}), 1, "glue");
}

TEST_F(FitRefusals, RefusesWhatIsNotALength) {
  for (const std::string option : {"--lambda", "--tolerance", "--voxel-size", "--fit-tolerance"})
    for (const std::string text : {"0", "-1", "nan", "inf", "ten", "10%%", "10 cm", "-5%"})
      expect_refusal(pair_.fit("map.vdb", {option + "=" + text}), 1,
                     "'" + text + "' is not a positive length");
}

TEST_F(FitRefusals, NamesTheFactorBetweenModelsInTwoUnitsUnlessAnySizeIsAsked) {
  TriangleMesh target = read_triangle_mesh(pair_.file("target.obj"));
  target.vertices *= 100;
  write_triangle_mesh(pair_.file("target.obj"), target);
  json anchors = read_json("anchors.json");
  for (json& pair : anchors["pairs"])
    for (json& coordinate : pair["b"]) coordinate = 100 * coordinate.get<double>();
  write_text(pair_.file("anchors.json"), anchors.dump());
  expect_refusal(pair_.fit("map.vdb"), 2, "times as large as the source by their anchors");
  EXPECT_EQ(pair_.fit("map.vdb", {"--any-size", "--require-certified"}).exit_code, 0);
}

// The models are of one size, whatever the ratio of the anchors' sides.
TEST_F(FitRefusals, NamesTheAnchorsWhereTheyAloneAreInAnotherUnit) {
  for (const char* side : {"a", "b"})
    for (const double factor : {2.54, 10.0, 100.0}) {
      json anchors = read_json("anchors.json");
      for (json& pair : anchors["pairs"])
        for (json& coordinate : pair[side]) coordinate = factor * coordinate.get<double>();
      write_text(pair_.file("scaled.json"), anchors.dump());
      const ProgramResult fit =
          bespoke({"fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors",
                   pair_.file("scaled.json"), "-o", pair_.file("map.vdb")});
      expect_refusal(fit, 2,
                     std::string(side == std::string("a") ? "source" : "target") + ", but would if their \"" +
                         side + "\" were multiplied by ");
    }
}

TEST_F(FitRefusals, RefusesAFittedSourceOfOtherConnectivity) {
  write_text(pair_.file("other.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_refusal(pair_.fit("map.vdb", {"--fitted", pair_.file("other.obj")}), 2,
                 pair_.file("other.obj") + " has 3 vertices and 1 faces, but the source has 642");
}

TEST_F(FitRefusals, RefusesUnknownEndingsBeforeItWorks) {
  expect_refusal(pair_.fit("map.vdb", {"--fitted-out", pair_.file("fitted.step")}), 1, "fitted.step");
}

TEST_F(FitRefusals, NamesTheMissingFile) {
  std::filesystem::remove(pair_.file("target.obj"));
  expect_refusal(pair_.fit("map.vdb"), 4, "target.obj");
}

TEST_F(FitRefusals, NamesTheLineOfABadFace) {
  write_text(pair_.file("target.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
  const ProgramResult fit = pair_.fit("map.vdb");
  expect_refusal(fit, 2, "target.obj");
  EXPECT_THAT(fit.err, HasSubstr("4"));
}

TEST_F(FitRefusals, RefusesAModelWithoutFaces) {
  write_text(pair_.file("source.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  expect_refusal(pair_.fit("map.vdb"), 2, "source.obj");
}

TEST_F(FitRefusals, RefusesAnchorsThatDoNotFixTheMap) {
  write_text(pair_.file("anchors.json"),
             R"({"pairs":[{"name":"p","a":[0,0,0],"b":[0,0,0]},{"name":"q","a":[1,0,0],"b":[1,0,0]}]})");
  expect_refusal(pair_.fit("map.vdb"), 2, "2");
  write_text(pair_.file("anchors.json"), R"({"pairs":[{"name":"p","a":[0,0,0],"b":[0,0]}]})");
  expect_refusal(pair_.fit("map.vdb"), 2, "anchors.json");
}

TEST_F(FitRefusals, NamesTheFileAndThePatchThatTheModelsDoNotHave) {
  json anchors = read_json("anchors.json");
  anchors["patches"] = {{{"name", "stand"}, {"b", {{"faces", {3, 70000}}}}, {"exclude", true}}};
  write_text(pair_.file("anchors.json"), anchors.dump());
  const ProgramResult fit = pair_.fit("map.vdb");
  expect_refusal(fit, 2, "anchors.json: patch \"stand\" on the target");
  EXPECT_THAT(fit.err, HasSubstr("no face 70000"));
  anchors["patches"][0]["b"]["faces"] = {3};
  write_text(pair_.file("anchors.json"), anchors.dump());
  expect_refusal(pair_.fit("map.vdb", {"--paper"}), 2, "leave the patches out");
}

// The number behind `before` in a message.
double number_after(const std::string& text, const std::string& before) {
  const std::size_t at = text.find(before);
  return at == std::string::npos ? 0 : std::stod(text.substr(at + before.size()));
}

TEST_F(FitRefusals, AdvisesALambdaThatWorksWhenTheSystemIsTooLarge) {
  const std::vector<std::string> options{"--elastic", "csrbf", "--max-memory", "1MiB", "--lambda"};
  const auto fit_with = [&](const std::string& lambda) {
    std::vector<std::string> all = options;
    all.push_back(lambda);
    return pair_.fit("map.vdb", all);
  };
  const ProgramResult refused = fit_with("50%");
  expect_refusal(refused, 4, "MB; use an effective distance of at most ");
  // The advice fits the memory of the system; what the bake then needs is another matter.
  const double advised = number_after(refused.err, "at most ");
  EXPECT_THAT(fit_with(std::to_string(0.999 * advised)).err, Not(HasSubstr("effective distance")));
}

TEST_F(FitRefusals, AdvisesALambdaThatWorksWhenTheSystemIsTooIllConditioned) {
  const ProgramResult refused = pair_.fit("map.vdb", {"--elastic", "csrbf", "--lambda", "3000%"});
  expect_refusal(refused, 3, "the system's condition is about");
  const double advised = number_after(refused.err, "use an effective distance of at most ");
  const ProgramResult fit = pair_.fit(
      "map.vdb", {"--elastic", "csrbf", "--voxel-size", "50%", "--lambda", std::to_string(0.999 * advised)});
  EXPECT_EQ(fit.exit_code, 0) << fit.err;
}

TEST_F(FitRefusals, AdvisesAVoxelSizeAndAToleranceThatFitTheMemory) {
  std::vector<std::string> options{"--elastic", "pffd-smooth",  "--max-memory",
                                   "40MB",      "--voxel-size", "0.1%"};
  const ProgramResult refused = pair_.fit("map.vdb", options);
  expect_refusal(refused, 4, "the limit is ");
  options.back() = std::to_string(number_after(refused.err, "; voxels of "));
  EXPECT_EQ(pair_.fit("map.vdb", options).exit_code, 0) << refused.err;
  expect_refusal(
      (std::filesystem::remove(pair_.file("map.vdb")),
       pair_.fit("map.vdb", {"--elastic", "pffd-smooth", "--max-memory", "1MB", "--voxel-size", "1%"})),
      4, "no voxel size fits, allow at least");
}

TEST_F(FitRefusals, AdvisesAToleranceThatFitsTheMemory) {
  const auto fit_with = [&](const std::string& tolerance, const char* memory) {
    return pair_.fit("map.vdb", {"--strict", "--tolerance", tolerance, "--max-memory", memory});
  };
  const ProgramResult refused = fit_with("0.001%", "100MB");
  expect_refusal(refused, 4, "the limit is 100 MB; a tolerance of ");
  const ProgramResult fit =
      fit_with(std::to_string(number_after(refused.err, "MB; a tolerance of ")), "100MB");
  EXPECT_EQ(fit.exit_code, 0) << refused.err << fit.err;
  std::filesystem::remove(pair_.file("map.vdb"));
  expect_refusal(fit_with("0.001%", "10MB"), 4, "the limit is 10 MB; no tolerance fits, allow at least ");
}

TEST_F(FitRefusals, TakesMemoryInBytesAndTheirMultiples) {
  for (const std::string size : {"4GiB", "4GB", "4096MB", "4294967296"})
    EXPECT_EQ(pair_.fit("map.vdb", {"--max-memory", size}).exit_code, 0) << size;
  for (const std::string size : {"much", "-1", "4 parsecs"})
    EXPECT_EQ(pair_.fit("map.vdb", {"--max-memory=" + size}).exit_code, 1) << size;
}

TEST_F(FitRefusals, DoesNotOverwriteItsInputs) {
  const std::string before = read_text(pair_.file("source.obj"));
  expect_refusal(pair_.fit("source.obj"), 1, "overwritten");
  expect_refusal(pair_.fit("map.vdb", {"--fitted-out", pair_.file("./target.obj")}), 1, "overwritten");
  expect_refusal(pair_.fit("map.vdb", {"--report", pair_.file("map.vdb")}), 1, "twice");
  EXPECT_EQ(read_text(pair_.file("source.obj")), before);
}

TEST_F(FitRefusals, NamesTheDirectoryThatDoesNotExist) {
  expect_refusal(pair_.fit("none/map.vdb"), 4, "none");
}

TEST_F(FitRefusals, LeavesNothingWhenAnOutputCannotBeWritten) {
  const std::vector<std::string> before = pair_.files();
  std::filesystem::create_directory(pair_.file("report.json"));
  expect_refusal(pair_.fit("map.vdb", {"--report", pair_.file("report.json")}), 4, "report.json");
  std::filesystem::remove(pair_.file("report.json"));
  EXPECT_EQ(pair_.files(), before);
}

class InterruptedFit : public FitCommand, public testing::WithParamInterface<int> {};

TEST_P(InterruptedFit, LeavesNothing) {
  const std::vector<std::string> before = pair_.files();
  RunningProgram fit({BESPOKE_COMMAND, "fit", pair_.file("source.obj"), pair_.file("target.obj"), "--anchors",
                      pair_.file("anchors.json"), "-o", pair_.file("map.vdb"), "--elastic", "csrbf",
                      "--voxel-size", "0.15%"});
  ASSERT_TRUE(fit.wait_for_error_text("bake: "));
  fit.send(GetParam());
  const ProgramResult result = fit.wait();
  EXPECT_EQ(result.exit_code, 128 + GetParam());
  EXPECT_THAT(result.err, HasSubstr("interrupted"));
  EXPECT_EQ(pair_.files(), before);
}

INSTANTIATE_TEST_SUITE_P(Signals, InterruptedFit, testing::Values(SIGINT, SIGTERM));

}  // namespace
}  // namespace bespoke::test
