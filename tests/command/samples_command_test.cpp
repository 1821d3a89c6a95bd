#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <nlohmann/json.hpp>

#include "command/example_pair.h"

namespace bespoke::test {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

TEST(SamplesCommand, WritesOnlyWhatIsNamed) {
  const ScratchDirectory directory;
  const std::string made = (directory / "made").string();
  const ProgramResult result = bespoke({"samples", made, "shoe"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  for (const char* name : {"shoe/source.obj", "shoe/target.obj", "shoe/anchors.json"}) {
    EXPECT_TRUE(std::filesystem::exists(directory / "made" / name)) << name;
    EXPECT_THAT(result.out, HasSubstr(name));
  }
  EXPECT_FALSE(std::filesystem::exists(directory / "made" / "dress"));
  EXPECT_THAT(bespoke({"samples", made, "shoe", "--quiet"}).out, IsEmpty());
}

TEST(SamplesCommand, LeavesWholeFilesWhenInterrupted) {
  const ScratchDirectory directory;
  RunningProgram samples({BESPOKE_COMMAND, "samples", directory.path().string(), "shoe", "glove"});
  ASSERT_TRUE(samples.wait_for_error_text("samples: "));
  samples.send(SIGINT);
  const ProgramResult result = samples.wait();
  EXPECT_EQ(result.exit_code, 130);
  EXPECT_THAT(result.err, HasSubstr("bespoke: interrupted\n"));
  EXPECT_FALSE(std::filesystem::exists(directory / "glove"));
  for (const auto& entry : std::filesystem::recursive_directory_iterator(directory.path()))
    if (entry.path().extension() == ".obj") {
      EXPECT_GT(read_obj_points(entry.path().string()).cols(), 1000) << entry.path();
    } else if (entry.path().extension() == ".json") {  // anchors and seams
      EXPECT_TRUE(nlohmann::json::accept(read_text(entry.path().string()))) << entry.path();
    } else {
      EXPECT_TRUE(entry.is_directory()) << entry.path();
    }
}

TEST(SamplesCommand, ListsTheNamesItKnows) {
  const ScratchDirectory directory;
  const ProgramResult result = bespoke({"samples", (directory / "made").string(), "boat"});
  EXPECT_EQ(result.exit_code, 1);
  for (const char* name : {"boat", "dress", "girths", "glasses", "glove", "shoe"})
    EXPECT_THAT(result.err, HasSubstr(name));
  EXPECT_EQ(bespoke({"samples"}).exit_code, 1);
}

TEST(SamplesCommand, NamesTheDirectoryThatCannotBeMade) {
  const ScratchDirectory directory;
  write_text(directory / "file", "");
  const ProgramResult result = bespoke({"samples", (directory / "file").string(), "shoe"});
  EXPECT_EQ(result.exit_code, 4);
  EXPECT_THAT(result.err, HasSubstr("file"));
}

}  // namespace
}  // namespace bespoke::test
