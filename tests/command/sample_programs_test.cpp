#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;

std::string program(const std::string& name) {
  return (std::filesystem::path(BESPOKE_COMMAND).parent_path() / name).string();
}

TEST(SamplePrograms, FitApplyAndInspect) {
  const ExamplePair pair;
  const ProgramResult fit = run_program(
      {program("fit_and_apply"), pair.file("source.obj"), pair.file("target.obj"), pair.file("anchors.json"),
       pair.file("product.obj"), pair.file("map.vdb"), pair.file("out.obj")});
  ASSERT_EQ(fit.exit_code, 0) << fit.err;
  EXPECT_EQ(read_obj_points(pair.file("out.obj")).cols(), 729);

  const ProgramResult apply = run_program({program("apply_asset"), pair.file("map.vdb")});
  EXPECT_EQ(apply.exit_code, 0) << apply.err;
  EXPECT_THAT(apply.out, HasSubstr("->"));

  const ProgramResult inspect = run_program({program("inspect_asset"), pair.file("map.vdb")});
  EXPECT_EQ(inspect.exit_code, 0) << inspect.err;
  EXPECT_THAT(inspect.out, HasSubstr("bijection: "));
  EXPECT_THAT(inspect.out, HasSubstr("p13"));
}

// Another program, which knows the file's description only, carries products to where the command does.
TEST(SamplePrograms, StrangersReaderAgreesWithApply) {
  if (run_program({"/usr/bin/python3", "-c", "import numpy, pyopenvdb"}).exit_code != 0)
    GTEST_SKIP() << "pyopenvdb (python3-openvdb) or NumPy is not installed";
  const ExamplePair pair;
  for (const std::vector<std::string>& extra : {std::vector<std::string>{}, {"--steps", "2"}}) {
    ASSERT_EQ(pair.fit("map.vdb", extra).exit_code, 0);
    ASSERT_EQ(pair.apply("map.vdb", {"-o", pair.file("ours.obj")}).exit_code, 0);
    const ProgramResult read =
        run_program({"/usr/bin/python3", BESPOKE_SOURCE_DIR "/samples/viewers/read_asset.py",
                     pair.file("map.vdb"), pair.file("product.obj"), pair.file("theirs.obj")});
    ASSERT_EQ(read.exit_code, 0) << read.err;
    const Points ours = read_obj_points(pair.file("ours.obj"));
    const Points theirs = read_obj_points(pair.file("theirs.obj"));
    const double diagonal = (ours.rowwise().maxCoeff() - ours.rowwise().minCoeff()).norm();
    EXPECT_LT((ours - theirs).cwiseAbs().maxCoeff(), 1e-6 * diagonal);
  }
  const std::string text = read_text(BESPOKE_SOURCE_DIR "/samples/viewers/read_asset.py");
  EXPECT_LE(std::count(text.begin(), text.end(), '\n'), 60);
}

TEST(SamplePrograms, NameWhatTheyNeed) {
  for (const std::string name : {"fit_and_apply", "apply_asset", "inspect_asset"}) {
    EXPECT_THAT(run_program({program(name)}).err, HasSubstr("usage: " + name));
    EXPECT_EQ(run_program({program(name)}).exit_code, 1);
  }
  EXPECT_THAT(run_program({program("inspect_asset"), "none.vdb"}).err, HasSubstr("none.vdb"));
}

const std::string sample = read_text(BESPOKE_SOURCE_DIR "/samples/fit_and_apply.cpp");

/// The lines of the sample from the first that reads to the last that writes, without their indentation.
std::string heart_of_the_sample() {
  const std::size_t begin = sample.find("  const bespoke::TriangleMesh source");
  const std::size_t end = sample.find("  std::printf(", begin);
  std::string lines = "\n" + sample.substr(begin, end - begin);
  for (std::size_t at = 0; (at = lines.find("\n  ", at)) != std::string::npos; ++at) lines.erase(at + 1, 2);
  return lines.substr(1);
}

TEST(Pages, ShowASampleVerbatim) {
  EXPECT_THAT(read_text(BESPOKE_SOURCE_DIR "/samples/README.md"), HasSubstr("```cpp\n" + sample + "```"));
  EXPECT_THAT(read_text(BESPOKE_SOURCE_DIR "/README.md"),
              HasSubstr("```cpp\n" + heart_of_the_sample() + "```"));
}

// The page of the command is written out of --help: tools/options.
TEST(Pages, NameEveryOptionOfTheCommand) {
  const ProgramResult check =
      run_program({"/usr/bin/python3", BESPOKE_SOURCE_DIR "/tools/options", BESPOKE_COMMAND, "--check"});
  EXPECT_EQ(check.exit_code, 0) << check.out << check.err;
}

}  // namespace
}  // namespace bespoke::test
