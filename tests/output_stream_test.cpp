#include "bespoke/output_stream.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstring>
#include <fstream>
#include <future>
#include <stdexcept>
#include <string>

#include "bespoke/atomic_file.h"
#include "bespoke/batch/line_log.h"
#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

// What is no regular file is written into or refused, and stays what it was.
namespace bespoke {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

mode_t kind_of(const fs::path& path) {
  struct stat status {};
  return ::lstat(path.c_str(), &status) == 0 ? status.st_mode & S_IFMT : 0;
}

class OutputStreams : public ::testing::Test {
 protected:
  static auto text(const std::string& content) {
    return [content](const fs::path& temporary) { std::ofstream(temporary) << content; };
  }
  fs::path pipe(const std::string& name) const {
    const fs::path path = directory_ / name;
    EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
    return path;
  }
  fs::path link_to(const fs::path& target) const {
    const fs::path link = directory_ / ("link_to_" + target.filename().string());
    fs::create_symlink(target, link);
    return link;
  }
  /// What another thread reads until the last writer closes the pipe.
  static std::future<std::string> reader_of(const fs::path& path) {
    return std::async(std::launch::async, [path] { return test::read_text(path); });
  }
  std::string refusal(const fs::path& path) const {
    return test::error_message<FileError>([&] { write_atomically(path, text("lost")); });
  }

  test::ScratchDirectory directory_;
};

TEST_F(OutputStreams, AreNeitherFilesNorDirectoriesNorAbsent) {
  const fs::path file = directory_ / "file", fifo = pipe("fifo");
  std::ofstream(file) << "content";
  for (const fs::path& path : {file, directory_.path(), directory_ / "none", directory_ / "none" / "none"})
    EXPECT_FALSE(is_stream(path)) << path;
  for (const fs::path& path : {fifo, link_to(fifo), fs::path("/dev/null")}) EXPECT_TRUE(is_stream(path));
  fs::create_symlink("round", directory_ / "round");
  EXPECT_FALSE(is_stream(directory_ / "round"));
}

TEST_F(OutputStreams, PipesTakeWhatIsWritten) {
  const fs::path fifo = pipe("fifo"), link = link_to(fifo);
  for (const fs::path& path : {fifo, link})
    for (const TemporaryFile kind : {TemporaryFile::unnamed_where_possible, TemporaryFile::named}) {
      auto read = reader_of(fifo);
      write_atomically(path, text(std::string(300'000, 'x') + "end"), kind);
      EXPECT_EQ(read.get(), std::string(300'000, 'x') + "end");
    }
  EXPECT_EQ(kind_of(fifo), mode_t{S_IFIFO});
  EXPECT_EQ(kind_of(link), mode_t{S_IFLNK});
}

TEST_F(OutputStreams, TakeNothingOfAnOutputThatFails) {
  const fs::path fifo = pipe("fifo");
  const int reader = ::open(fifo.c_str(), O_RDONLY | O_NONBLOCK);
  EXPECT_THROW(write_atomically(fifo,
                                [](const fs::path& temporary) {
                                  std::ofstream(temporary) << "half";
                                  throw std::runtime_error("no more");
                                }),
               std::runtime_error);
  char byte = 0;
  EXPECT_EQ(::read(reader, &byte, 1), 0);
  ::close(reader);
}

TEST_F(OutputStreams, AreNotRemoved) {
  const fs::path fifo = pipe("fifo"), link = link_to(fifo);
  remove_written(fifo);
  remove_written(link);
  EXPECT_EQ(kind_of(fifo), mode_t{S_IFIFO});
  EXPECT_EQ(kind_of(link), mode_t{S_IFLNK});
}

TEST_F(OutputStreams, OfALinkToAFileTheFileIsRemoved) {
  const fs::path file = directory_ / "file", link = link_to(file);
  write_atomically(link, text("new"));
  remove_written(link);
  EXPECT_EQ(kind_of(link), mode_t{S_IFLNK});
  EXPECT_FALSE(fs::exists(file));
}

TEST_F(OutputStreams, DevicesTakeWhatIsWritten) {
  const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(terminal, 0);
  ASSERT_EQ(::grantpt(terminal) + ::unlockpt(terminal), 0);
  const fs::path device = ::ptsname(terminal);
  const fs::path link = directory_ / "terminal";
  fs::create_symlink(device, link);
  for (const fs::path& path : {device, link}) {
    write_atomically(path, text("out\n"));
    char bytes[16] = {};
    ASSERT_GT(::read(terminal, bytes, sizeof bytes), 0);
    EXPECT_THAT(std::string(bytes), HasSubstr("out"));
  }
  EXPECT_EQ(kind_of(device), mode_t{S_IFCHR});
  ::close(terminal);
}

TEST_F(OutputStreams, ANullDeviceOfItsOwnStays) {
  const fs::path device = directory_ / "null", link = directory_ / "link";
  if (::mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0) GTEST_SKIP() << "only root makes devices";
  fs::create_symlink("null", link);
  for (const fs::path& path : {device, link}) {
    write_atomically(path, text("gone"));
    remove_written(path);
  }
  EXPECT_EQ(kind_of(device), mode_t{S_IFCHR});
  EXPECT_EQ(kind_of(link), mode_t{S_IFLNK});
}

TEST_F(OutputStreams, BlockDevicesAreRefused) {
  const fs::path device = directory_ / "disk";
  if (::mknod(device.c_str(), S_IFBLK | 0600, makedev(0, 0)) != 0) GTEST_SKIP() << "only root makes devices";
  EXPECT_THAT(refusal(device), AllOf(HasSubstr("disk: it is a block device"), HasSubstr("name a file")));
  EXPECT_EQ(kind_of(device), mode_t{S_IFBLK});
}

TEST_F(OutputStreams, SocketsAreRefused) {
  const fs::path path = directory_ / "socket";
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  ASSERT_LT(path.string().size(), sizeof address.sun_path);
  std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
  const int socket = ::socket(AF_UNIX, SOCK_STREAM, 0);
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  EXPECT_THAT(refusal(path), HasSubstr("socket: it is a socket"));
  EXPECT_EQ(kind_of(path), mode_t{S_IFSOCK});
  ::close(socket);
}

/// What a shell's `> FILE` gives a program that writes to /dev/stdout.
TEST_F(OutputStreams, OpenFilesOfTheProcessAreWrittenOn) {
  const fs::path file = directory_ / "file";
  const int open = ::open(file.c_str(), O_CREAT | O_WRONLY, 0600);
  ASSERT_EQ(::write(open, "before ", 7), 7);
  const fs::path name = "/dev/fd/" + std::to_string(open);
  EXPECT_TRUE(is_stream(name));
  write_atomically(name, text("output "));
  remove_written(name);
  ASSERT_EQ(::write(open, "after", 5), 5);
  ::close(open);
  EXPECT_EQ(test::read_text(file), "before output after");
  EXPECT_FALSE(is_stream(name));
}

TEST_F(OutputStreams, SayThatTheirReaderHasGone) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const auto before = ::signal(SIGPIPE, SIG_IGN);
  EXPECT_THAT(refusal("/dev/fd/" + std::to_string(ends[1])), HasSubstr("its reader has gone"));
  ::signal(SIGPIPE, before);
  ::close(ends[1]);
}

TEST_F(OutputStreams, TakeLinesOfALog) {
  const fs::path fifo = pipe("fifo");
  auto read = reader_of(fifo);
  {
    LineLog log(fifo);
    log.append("one");
    log.append("two");
  }
  EXPECT_EQ(read.get(), "one\ntwo\n");
  EXPECT_EQ(kind_of(fifo), mode_t{S_IFIFO});
}

TEST_F(OutputStreams, HaveNoTemporariesBesideThem) {
  EXPECT_EQ(directory_of_temporaries(pipe("fifo")), fs::temp_directory_path());
  EXPECT_EQ(directory_of_temporaries(directory_ / "file"), directory_.path());
}

TEST_F(OutputStreams, DirectoriesAreMadeAndFilesInTheirWayNamed) {
  std::ofstream(directory_ / "file") << "content";
  make_directories(directory_ / "a" / "b");
  make_directories(directory_ / "a" / "b");
  EXPECT_TRUE(fs::is_directory(directory_ / "a" / "b"));
  for (const fs::path& path : {directory_ / "file", directory_ / "file" / "below"})
    EXPECT_THAT(test::error_message<FileError>([&] { make_directories(path); }),
                HasSubstr("/file: is no directory but a file; name another"));
}

}  // namespace
}  // namespace bespoke
