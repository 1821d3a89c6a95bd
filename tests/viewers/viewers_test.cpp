#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command/example_pair.h"

// Programs that other people have, doing more with a map than looking at it: samples/viewers.
namespace bespoke::test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const std::string viewers = BESPOKE_SOURCE_DIR "/samples/viewers";
const std::string laws = BESPOKE_SOURCE_DIR "/tests/viewers";

TEST(Blender, LawsOfTheAddOnHold) {
  if (run_program({"blender", "--version"}).exit_code != 0) GTEST_SKIP() << "blender is not installed";
  const ExamplePair pair;
  ASSERT_EQ(pair.fit("map.vdb").exit_code, 0);
  const std::string directory = std::filesystem::path(pair.file("map.vdb")).parent_path();
  const ProgramResult run =
      run_program({"blender", "-b", "--factory-startup", "--python-exit-code", "1", "-P",
                   laws + "/blender_laws.py", "--", directory, BESPOKE_COMMAND, viewers + "/blender"});
  EXPECT_EQ(run.exit_code, 0) << run.out << run.err;
  EXPECT_THAT(run.out, HasSubstr("held: t_moves_meshes_where_the_add_on_is_absent"));
  EXPECT_THAT(run.out, Not(HasSubstr("broken: "))) << run.err;
}

}  // namespace
}  // namespace bespoke::test
