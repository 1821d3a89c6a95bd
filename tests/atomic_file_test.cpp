#include "bespoke/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <fstream>
#include <functional>
#include <string>
#include <thread>
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
using ::testing::SizeIs;
using ::testing::StartsWith;

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

  /// The signal that ended a child process which ran the body, or 0.
  static int in_child(const std::function<void()>& body) {
    const pid_t child = fork();
    if (child == 0) {
      body();
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) ? WTERMSIG(status) : WEXITSTATUS(status);
  }

  test::ScratchDirectory directory_;
};

constexpr std::array kinds{TemporaryFile::unnamed_where_possible, TemporaryFile::named};

TEST_F(WriteAtomically, CreatesAndReplaces) {
  const fs::path path = directory_ / "file.txt";
  write_atomically(path, text("old"));
  EXPECT_EQ(test::read_text(path), "old");
  write_atomically(path, text("new"));
  EXPECT_EQ(test::read_text(path), "new");
  EXPECT_THAT(names(), ElementsAre("file.txt"));
}

TEST_F(WriteAtomically, ShowsNothingBeforeTheEnd) {
  for (const TemporaryFile kind : kinds) {
    write_atomically(
        directory_ / "mesh.obj",
        [&](const fs::path& temporary) {
          std::ofstream(temporary) << "v 0 0 0";
          EXPECT_EQ(names().size(), kind == TemporaryFile::named ? 1u : 0u);
          for (const std::string& name : names()) EXPECT_THAT(name, StartsWith(".mesh.obj."));
        },
        kind);
    EXPECT_EQ(test::read_text(directory_ / "mesh.obj"), "v 0 0 0");
    EXPECT_THAT(names(), ElementsAre("mesh.obj"));
    fs::remove(directory_ / "mesh.obj");
  }
}

TEST_F(WriteAtomically, LeavesNothingOfAKilledWriter) {
  const auto killed = [](const fs::path& temporary) {
    std::ofstream(temporary) << "half of the ne" << std::flush;
    std::raise(SIGKILL);
  };
  EXPECT_EQ(in_child([&] { write_atomically(directory_ / "file.txt", killed); }), SIGKILL);
  EXPECT_THAT(names(), IsEmpty());
  EXPECT_EQ(in_child([&] { write_atomically(directory_ / "file.txt", killed, TemporaryFile::named); }),
            SIGKILL);
  EXPECT_THAT(names(), SizeIs(1));
  // The next process that writes there.
  EXPECT_EQ(in_child([&] { write_atomically(directory_ / "other.txt", text("new"), TemporaryFile::named); }),
            0);
  EXPECT_THAT(names(), ElementsAre("other.txt"));
}

TEST_F(WriteAtomically, LeavesTheTemporariesOfOthersThatLive) {
  write_atomically(
      directory_ / "file.txt",
      [&](const fs::path& temporary) {
        std::ofstream(temporary) << "new";
        EXPECT_EQ(in_child([&] {
                    write_atomically(directory_ / "other.txt", text("other"), TemporaryFile::named);
                  }),
                  0);
      },
      TemporaryFile::named);
  EXPECT_EQ(test::read_text(directory_ / "file.txt"), "new");
  EXPECT_THAT(names(), ElementsAre("file.txt", "other.txt"));
}

TEST_F(WriteAtomically, ReplacesWhatAKilledReplacementLeft) {
  test::write_text(directory_ / "file.txt", "old");
  test::write_text(directory_ / ".file.txt.bespoke-new", "never renamed");
  write_atomically(directory_ / "file.txt", text("new"));
  EXPECT_EQ(test::read_text(directory_ / "file.txt"), "new");
  EXPECT_THAT(names(), ElementsAre("file.txt"));
}

TEST_F(WriteAtomically, TakesOneOfManyWritersAtATime) {
  const fs::path path = directory_ / "file.txt";
  write_atomically(path, text(std::string(5000, '0')));
  std::vector<std::thread> writers;
  for (char letter = 'a'; letter < 'e'; ++letter)
    writers.emplace_back([&, letter] {
      for (int i = 0; i < 50; ++i) {
        write_atomically(path, text(std::string(5000, letter)));
        const std::string found = test::read_text(path);
        EXPECT_EQ(found, std::string(5000, found.front()));
      }
    });
  for (std::thread& writer : writers) writer.join();
  EXPECT_THAT(names(), ElementsAre("file.txt"));
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
  EXPECT_THROW(write_atomically(
                   directory_ / "file.txt", [](const fs::path& temporary) { fs::remove(temporary); },
                   TemporaryFile::named),
               FileError);
}

TEST_F(WriteAtomically, HoldsWhatIsToGoElsewhere) {
  test::write_text(directory_ / "old.txt", "old");
  const fs::path absent = directory_ / "absent" / "new.txt";
  for (const TemporaryFile kind : kinds) {
    HeldFiles held(directory_.path());
    held.hold([&] {
      EXPECT_TRUE(writes_are_held());
      EXPECT_EQ(directory_of_temporaries(absent), directory_.path());
      write_atomically(directory_ / "old.txt", text("first"), kind);
      write_atomically(absent, text("new"), kind);
      write_atomically(directory_ / "old.txt", text("second"), kind);
    });
    EXPECT_FALSE(writes_are_held());
    EXPECT_EQ(directory_of_temporaries(absent), absent.parent_path());
    const std::vector<HeldFiles::File> files = held.files();
    ASSERT_THAT(files, SizeIs(2));
    EXPECT_EQ(files[0].path, absent);
    EXPECT_EQ(test::read_text(files[0].content), "new");
    EXPECT_EQ(files[1].path, directory_ / "old.txt");
    EXPECT_EQ(test::read_text(files[1].content), "second");
    EXPECT_EQ(test::read_text(directory_ / "old.txt"), "old");
    EXPECT_THAT(names(), SizeIs(kind == TemporaryFile::named ? 3 : 1));
  }
  EXPECT_THAT(names(), ElementsAre("old.txt"));
}

TEST_F(WriteAtomically, RemovesWhatIsHeldAndNotWhatHasItsName) {
  const fs::path path = directory_ / "file.txt";
  write_atomically(path, text("old"));
  HeldFiles held(directory_.path());
  held.hold([&] {
    write_atomically(path, text("new"));
    remove_written(path);
  });
  EXPECT_THAT(held.files(), IsEmpty());
  EXPECT_EQ(test::read_text(path), "old");
  remove_written(path);
  remove_written(path);
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(WriteAtomically, HoldsOnOneThreadAlone) {
  HeldFiles held(directory_.path());
  held.hold([&] {
    std::thread([&] { write_atomically(directory_ / "other.txt", text("other")); }).join();
    EXPECT_THROW(
        write_atomically(directory_ / "file.txt", [](const fs::path&) { throw FileError("no space left"); }),
        FileError);
  });
  EXPECT_THAT(held.files(), IsEmpty());
  EXPECT_THAT(names(), ElementsAre("other.txt"));
  EXPECT_THROW(held.hold([] { throw Interrupted("interrupted"); }), Interrupted);
  EXPECT_FALSE(writes_are_held());
}

TEST_F(WriteAtomically, FlushesDirectoriesLater) {
  LateDirectories directories;
  for (const char* name : {"one", "two"}) fs::create_directory(directory_ / name);
  directories.note([&] {
    write_atomically(directory_ / "one/file.txt", text("old"));
    write_atomically(directory_ / "one/file.txt", text("new"));
    write_atomically(directory_ / "two/file.txt", text("other"));
  });
  EXPECT_EQ(test::read_text(directory_ / "one/file.txt"), "new");
  EXPECT_EQ(test::read_text(directory_ / "two/file.txt"), "other");
  // One that is gone since holds no names to be lost.
  fs::remove_all(directory_ / "two");
  EXPECT_NO_THROW(directories.flush());
}

}  // namespace
}  // namespace bespoke
