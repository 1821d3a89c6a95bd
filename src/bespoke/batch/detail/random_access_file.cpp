#include "bespoke/batch/detail/random_access_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {

RandomAccessFile::RandomAccessFile(const std::filesystem::path& path, Access access,
                                   std::filesystem::path name)
    : RandomAccessFile(std::move(name)) {
  access == Access::write_alone ? open_alone(path) : open(path, access == Access::read ? O_RDONLY : O_RDWR);
}

RandomAccessFile::~RandomAccessFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void RandomAccessFile::fail(const char* what) const {
  throw FileError(name_.string() + ": " + what + ": " + std::strerror(errno));
}

void RandomAccessFile::open(const std::filesystem::path& path, int flags) {
  struct stat status;
  // Not waiting for the other end, should it be a pipe.
  descriptor_ = ::open(path.c_str(), flags | O_CLOEXEC | O_NONBLOCK, 0666);
  if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0) fail("cannot be opened");
  if (!S_ISREG(status.st_mode)) throw FileError(name_.string() + ": is no regular file");
}

void RandomAccessFile::open_alone(const std::filesystem::path& path) {
  for (;;) {
    open(path, O_RDWR | O_CREAT);
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EWOULDBLOCK) throw FileError(name_.string() + ": another process is writing it");
      fail("cannot be locked, so two might write it at once");
    }
    // Who had it locked may have put another file in its place just before.
    struct stat own, named;
    if (::fstat(descriptor_, &own) == 0 && ::stat(path.c_str(), &named) == 0 && named.st_ino == own.st_ino &&
        named.st_dev == own.st_dev)
      return;
    ::close(std::exchange(descriptor_, -1));
  }
}

std::uint64_t RandomAccessFile::size() const {
  struct stat status;
  if (::fstat(descriptor_, &status) != 0) fail("cannot be read");
  return static_cast<std::uint64_t>(status.st_size);
}

std::string RandomAccessFile::read(std::uint64_t offset, std::uint64_t bytes) const {
  std::string content(bytes, '\0');
  std::uint64_t done = 0;
  while (done < bytes) {
    const ssize_t count =
        ::pread(descriptor_, content.data() + done, bytes - done, static_cast<off_t>(offset + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot be read");
    if (count == 0) break;
    done += static_cast<std::uint64_t>(count);
  }
  content.resize(done);
  return content;
}

void RandomAccessFile::write(std::uint64_t offset, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot be written");
    bytes.remove_prefix(static_cast<std::size_t>(count));
    offset += static_cast<std::uint64_t>(count);
  }
}

void RandomAccessFile::cut(std::uint64_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail("cannot be written");
}

void RandomAccessFile::flush() {
  if (::fsync(descriptor_) != 0) fail("cannot be written");
}

}  // namespace bespoke
