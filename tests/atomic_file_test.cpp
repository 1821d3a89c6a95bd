#include "bespoke/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class WriteAtomically : public ::testing::Test {
 protected:
  static auto text(const std::string& content) {
    return [content](const fs::path& temporary) { std::ofstream(temporary) << content; };
  }
  std::vector<std::string> names() const {
    std::vector<std::string> result;
    for (const auto& entry : fs::directory_iterator(directory_.path()))
      result.push_back(entry.path().filename());
    std::sort(result.begin(), result.end());
    return result;
  }

  test::ScratchDirectory directory_;
};

TEST_F(WriteAtomically, CreatesAndReplaces) {
  const fs::path path = directory_ / "file.txt";
  write_atomically(path, text("old"));
  EXPECT_EQ(test::read_text(path), "old");
  write_atomically(path, text("new"));
  EXPECT_EQ(test::read_text(path), "new");
  EXPECT_THAT(names(), ElementsAre("file.txt"));
}

TEST_F(WriteAtomically, WritesToAHiddenNeighbourWithTheSameEnding) {
  const fs::path path = directory_ / "mesh.obj";
  write_atomically(path, [&](const fs::path& temporary) {
    EXPECT_EQ(temporary.parent_path(), path.parent_path());
    EXPECT_EQ(temporary.extension(), ".obj");
    EXPECT_EQ(temporary.filename().string().front(), '.');
    EXPECT_FALSE(fs::exists(path));
  });
  EXPECT_EQ(test::read_text(path), "");
}

TEST_F(WriteAtomically, LeavesTheOldContentAndNothingElseWhenTheWriterThrows) {
  const fs::path path = directory_ / "file.txt";
  write_atomically(path, text("old"));
  EXPECT_THROW(write_atomically(path,
                                [](const fs::path& temporary) {
                                  std::ofstream(temporary) << "half of the ne";
                                  throw Interrupted("interrupted");
                                }),
               Interrupted);
  EXPECT_EQ(test::read_text(path), "old");
  EXPECT_THAT(names(), ElementsAre("file.txt"));
}

TEST_F(WriteAtomically, LeavesNothingWhenAFirstWriteFails) {
  EXPECT_THROW(write_atomically(directory_ / "file.txt",
                                [](const fs::path&) { throw FileError("no space left on device"); }),
               FileError);
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(WriteAtomically, NamesTheMissingDirectoryAndTheReason) {
  const fs::path path = directory_ / "absent" / "file.txt";
  try {
    write_atomically(path, text("x"));
    FAIL();
  } catch (const FileError& error) {
    EXPECT_THAT(error.what(), HasSubstr(path.string()));
    EXPECT_THAT(error.what(), HasSubstr("No such file or directory"));
  }
}

TEST_F(WriteAtomically, RefusesADirectory) {
  EXPECT_THROW(write_atomically(directory_.path(), text("x")), FileError);
  EXPECT_THROW(write_atomically(directory_ / "", text("x")), FileError);
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(WriteAtomically, ReplacesWhatALinkPointsTo) {
  const fs::path path = directory_ / "file.txt";
  const fs::path link = directory_ / "link.txt";
  write_atomically(path, text("old"));
  fs::create_symlink("file.txt", link);
  write_atomically(link, text("new"));
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(test::read_text(path), "new");
}

TEST_F(WriteAtomically, KeepsThePermissionsOfAnExistingFile) {
  const fs::path path = directory_ / "file.txt";
  write_atomically(path, text("old"));
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  write_atomically(path, text("new"));
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(WriteAtomically, FailsWhenTheWriterLeavesNoFile) {
  EXPECT_THROW(
      write_atomically(directory_ / "file.txt", [](const fs::path& temporary) { fs::remove(temporary); }),
      FileError);
}

}  // namespace
}  // namespace bespoke
