#include "bespoke/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what, const fs::path& path, int error) {
  throw FileError(what + " " + path.string() + ": " + std::strerror(error));
}

class Descriptor {
 public:
  Descriptor(const fs::path& path, int flags, mode_t mode = 0) : number_(::open(path.c_str(), flags, mode)) {}
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }

 private:
  int number_;
};

/// A new, empty file beside the target; gone with the object unless it has been renamed.
class Temporary {
 public:
  explicit Temporary(const fs::path& target) : target_(target) {
    static std::atomic<unsigned> counter{0};
    // Names of other processes may be in the way: their ids repeat over time and between machines that
    // share a disk.
    for (int attempt = 0; attempt < 100; ++attempt) {
      std::string name(".");
      name += target.stem().string() + '.' + std::to_string(::getpid()) + '-' + std::to_string(counter++);
      path_ = target.parent_path() / (name + target.extension().string());
      const Descriptor file(path_, O_CREAT | O_EXCL | O_WRONLY | O_CLOEXEC, 0666);
      if (file.number() >= 0) return;
      if (errno != EEXIST) break;
    }
    fail("cannot create a file for", target, errno);
  }
  ~Temporary() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  const fs::path& path() const { return path_; }

  void flush() const {
    const Descriptor file(path_, O_RDONLY | O_CLOEXEC);
    if (file.number() < 0 || ::fsync(file.number()) != 0) fail("cannot write", target_, errno);
    struct stat old;
    if (::stat(target_.c_str(), &old) == 0 && ::fchmod(file.number(), old.st_mode & 07777) != 0)
      fail("cannot keep the permissions of", target_, errno);
  }

  void rename() {
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail("cannot replace", target_, errno);
    path_.clear();
  }

 private:
  fs::path target_;
  fs::path path_;
};

fs::path followed(const fs::path& path) {
  std::error_code error;
  if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
  const fs::path target = fs::weakly_canonical(path, error);
  if (error) fail("cannot follow", path, error.value());
  return target;
}

void flush_directory(const fs::path& target) {
  const fs::path directory = target.has_parent_path() ? target.parent_path() : fs::path(".");
  const Descriptor descriptor(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // Some file systems cannot flush a directory (EINVAL), and one may be writable but not readable: the
  // rename has happened, so neither is a failure.
  if (descriptor.number() >= 0 && ::fsync(descriptor.number()) != 0 && errno == EIO)
    fail("cannot write the directory", directory, errno);
}

}  // namespace

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  const fs::path target = followed(path);
  std::error_code ignored;
  if (target.filename().empty() || fs::is_directory(target, ignored)) fail("cannot write", path, EISDIR);
  Temporary temporary(target);
  write(temporary.path());
  temporary.flush();
  temporary.rename();
  flush_directory(target);
}

}  // namespace bespoke
