#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/example_pair.h"
#include "product/rig_scene.h"

// Programs that other people have, doing more with a map than looking at it: samples/viewers.
namespace bespoke::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string viewers = BESPOKE_SOURCE_DIR "/samples/viewers";
const std::string plugin = viewers + "/paraview/plugin/bespoke_maps.py";
const std::string scripts = BESPOKE_SOURCE_DIR "/tests/viewers";

// What vdb_print and the NanoVDB tools say of an asset is tested with the asset.
TEST(VdbView, ShowsAMap) {
  for (const char* program : {"vdb_view", "xvfb-run", "script"})
    if (!is_installed(program)) GTEST_SKIP() << program << " is not installed";
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const ProgramResult run =
      run_program({"/usr/bin/python3", scripts + "/vdb_view_draws.py", pair.file("map.vdb")});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
}

TEST(Blender, PropertiesOfTheAddOnHold) {
  if (!is_installed("blender")) GTEST_SKIP() << "blender is not installed";
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const std::string directory = std::filesystem::path(pair.file("map.vdb")).parent_path();
  const ProgramResult run =
      run_program({"blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P",
                   scripts + "/blender_test.py", "--", directory, BESPOKE_COMMAND, viewers + "/blender"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("held: t_moves_meshes_where_the_add_on_is_absent"));
  EXPECT_THAT(run.out, Not(HasSubstr("broken: "))) << run.err;
}

/// The sleeve of RigScene around the source of the pair, and what its map makes of it.
void write_rigged_sleeve(const ExamplePair& pair) {
  RigScene rig;
  rig.scene.root["nodes"][0]["translation"] = {-0.5, 1, 1.5};
  rig.scene.root["nodes"][0]["scale"] = {0.25, 0.25, 0.25};
  write_text(pair.file("sleeve.glb"), rig.glb());
  std::string points = "x,y,z\n";
  Points shown =
      read_product(pair.file("sleeve.glb")).vertices.rightCols(RigScene::rings * RigScene::corners);
  shown.conservativeResize(3, shown.cols() + 1);
  shown.rightCols<1>().setZero();  // the elbow
  for (const auto& x : shown.colwise())
    points += std::to_string(x[0]) + "," + std::to_string(x[1]) + "," + std::to_string(x[2]) + "\n";
  write_text(pair.file("shown.csv"), points);
  const auto apply = [&](const std::string& product, const std::string& output,
                         const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"apply", pair.file("map.vdb"), pair.file(product), "--unit", "map",
                                   "-o",    pair.file(output)};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramResult run = bespoke(words);
    ASSERT_EQ(run.exit_code, 0) << run.err;
  };
  apply("shown.csv", "expected.csv");
  apply("sleeve.glb", "carried.glb");
  apply("sleeve.glb", "bound.glb", {"--skeleton", pair.file("carried.glb")});
}

TEST(Blender, PropertiesOfCarriedSkeletonsHold) {
  if (!is_installed("blender")) GTEST_SKIP() << "blender is not installed";
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  write_rigged_sleeve(pair);
  const std::string directory = std::filesystem::path(pair.file("map.vdb")).parent_path();
  const ProgramResult run = run_program({"blender", "-b", "--factory-startup", "--python-exit-code", "1",
                                         "-P", scripts + "/blender_rig_test.py", "--", directory});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("held: elbow_of_the_targets_skeleton_bends_the_bound_sleeve"));
  EXPECT_THAT(run.out, Not(HasSubstr("broken: "))) << run.err;
}

class ParaView : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!is_installed("pvbatch")) GTEST_SKIP() << "pvbatch (paraview) is not installed";
    if (run_program({"/usr/bin/python3", "-c", "import numpy, paraview, pyopenvdb"}).exit_code != 0)
      GTEST_SKIP() << "ParaView's Python lacks pyopenvdb, NumPy or paraview itself (python3-paraview)";
    ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
    ASSERT_EQ(pair_.apply("map.vdb", {"-o", pair_.file("moved.obj")}).exit_code, 0);
  }

  // With what ParaView needs from Python 3.11 on.
  static ProgramResult run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"env", "PYTHONPATH=" + viewers + "/paraview/python311"});
    return run_program(arguments);
  }

  ExamplePair pair_;
};

TEST_F(ParaView, PropertiesOfThePluginHold) {
  const std::string directory = std::filesystem::path(pair_.file("map.vdb")).parent_path();
  const ProgramResult result = run({"pvbatch", scripts + "/paraview_test.py", directory, plugin});
  EXPECT_EQ(result.exit_code, 0) << result.out << result.err;
  EXPECT_THAT(result.out, HasSubstr("held: contour_of_the_distance_is_the_source"));
}

TEST_F(ParaView, RefusesWhatIsNoMap) {
  write_text(pair_.file("other.py"), R"(
import sys
import paraview.simple as pv
import pyopenvdb as vdb
grid = vdb.FloatGrid()
grid.name = 'density'
grid.fill((0, 0, 0), (3, 3, 3), 1.0)
vdb.write(sys.argv[2], [grid])
pv.LoadPlugin(sys.argv[1], ns=globals())
BespokeMap(FileName=sys.argv[2]).UpdatePipeline()
)");
  const ProgramResult result = run({"pvbatch", pair_.file("other.py"), plugin, pair_.file("smoke.vdb")});
  EXPECT_THAT(result.out + result.err, HasSubstr("smoke.vdb is no map of bespoke"));
}

TEST_F(ParaView, DrawsThePictureOfTheManualAndItsStateLoads) {
  if (!is_installed("xvfb-run")) GTEST_SKIP() << "xvfb-run (xvfb) is not installed";
  const std::vector<std::string> display{"xvfb-run", "-a", "-s", "-screen 0 1280x1024x24 -noreset",
                                         "pvbatch"};
  std::vector<std::string> draw = display;
  draw.insert(draw.end(), {viewers + "/paraview/picture.py", pair_.file("map.vdb"), pair_.file("product.obj"),
                           pair_.file("map.png"), pair_.file("map.pvsm")});
  const ProgramResult drawn = run(draw);
  ASSERT_EQ(drawn.exit_code, 0) << drawn.out << drawn.err;
  EXPECT_GT(std::filesystem::file_size(pair_.file("map.png")), 10'000u);
  write_text(pair_.file("load.py"), R"(
import sys
import paraview.simple as pv
pv.LoadPlugin(sys.argv[1])
pv.LoadState(sys.argv[2])
names = [name for name, _ in pv.GetSources()]
print(*sorted(names))
pv.SaveScreenshot(sys.argv[3])
)");
  std::vector<std::string> load = display;
  load.insert(load.end(), {pair_.file("load.py"), plugin, pair_.file("map.pvsm"), pair_.file("again.png")});
  const ProgramResult loaded = run(load);
  ASSERT_EQ(loaded.exit_code, 0) << loaded.out << loaded.err;
  EXPECT_THAT(loaded.out, HasSubstr("BespokeCarry1 BespokeCarry2 BespokeCarry3 BespokeMap1"));
  EXPECT_GT(std::filesystem::file_size(pair_.file("again.png")), 10'000u);
}

/// The number after "max " in the line that begins with "error".
double stated_error(const std::string& out) {
  return std::stod(out.substr(out.find("max ", out.find("error")) + 4));
}

double largest_distance(const Points& some, const Points& others) {
  return (some - others).colwise().norm().maxCoeff();
}

class Itk : public ::testing::TestWithParam<std::tuple<std::string, std::string>> {
 protected:
  void SetUp() override {
    if (std::string(BESPOKE_ITK_PROGRAM).empty())
      GTEST_SKIP() << "ITK (libinsighttoolkit5-dev) was not found when the tests were built";
    ASSERT_EQ(pair_.fit("map.vdb").exit_code, 0);
  }

  /// What ITK does with the image of the map is what `apply` does, to the error that export states.
  void expect_agreement(const std::string& verb, const std::vector<std::string>& of_export,
                        const std::vector<std::string>& of_apply) const {
    const auto& [ending, space] = GetParam();
    const std::string image = pair_.file("image" + ending);
    std::vector<std::string> write{"export", pair_.file("map.vdb"), "--grid", "3%", "--space", space, "-o",
                                   image};
    write.insert(write.end(), of_export.begin(), of_export.end());
    const ProgramResult written = bespoke(write);
    ASSERT_EQ(written.exit_code, 0) << written.err;
    const ProgramResult run = run_program(
        {BESPOKE_ITK_PROGRAM, verb, image, space, pair_.file("places.obj"), pair_.file("found.obj")});
    ASSERT_EQ(run.exit_code, 0) << run.err;
    std::vector<std::string> carry{"apply", pair_.file("map.vdb"), pair_.file("places.obj"), "-o",
                                   pair_.file("expected.obj")};
    carry.insert(carry.end(), of_apply.begin(), of_apply.end());
    ASSERT_EQ(bespoke(carry).exit_code, 0);

    const Points places = read_obj_points(pair_.file("places.obj"));
    const Points expected = read_obj_points(pair_.file("expected.obj"));
    const double error = stated_error(written.out);
    ASSERT_GT(places.cols(), 1000);
    EXPECT_GT(largest_distance(places, expected), 10 * error) << "they would agree without moving";
    EXPECT_LE(largest_distance(read_obj_points(pair_.file("found.obj")), expected), error);
  }

  ExamplePair pair_;
};

TEST_P(Itk, MovesPointsAsApplyDoes) { expect_agreement("move", {}, {}); }

TEST_P(Itk, ResamplesByTheWayBack) { expect_agreement("resample", {"--pull"}, {"--inverse"}); }

std::string in_words(const ::testing::TestParamInfo<Itk::ParamType>& image) {
  const auto& [ending, space] = image.param;
  return std::string(ending == ".nrrd" ? "Nrrd" : "Nifti") + (space == "lps" ? "InLps" : "InRas");
}

INSTANTIATE_TEST_SUITE_P(Images, Itk,
                         ::testing::Combine(::testing::Values(".nrrd", ".nii.gz"),
                                            ::testing::Values("lps", "ras")),
                         in_words);

}  // namespace
}  // namespace bespoke::test
