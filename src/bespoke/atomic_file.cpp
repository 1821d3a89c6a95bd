#include "bespoke/atomic_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/output_stream.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what, const fs::path& path, int error) {
  throw FileError(what + " " + path.string() + ": " + std::strerror(error));
}

class Descriptor {
 public:
  Descriptor() = default;
  Descriptor(const fs::path& path, int flags, mode_t mode = 0) : number_(::open(path.c_str(), flags, mode)) {}
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  Descriptor& operator=(Descriptor&& other) noexcept {
    close();
    number_ = std::exchange(other.number_, -1);
    return *this;
  }
  int number() const { return number_; }
  bool is_open() const { return number_ >= 0; }

 private:
  void close() {
    if (number_ >= 0) ::close(number_);
  }

  int number_ = -1;
};

constexpr std::string_view part_ending = ".bespoke-part";
constexpr std::string_view new_ending = ".bespoke-new";

// Others take a name, or a file, away only by doing the same at the same moment.
constexpr int max_attempts = 1000;

fs::path directory_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : "."; }

/// What lies beside a stream is not ours.
fs::path directory_for_temporaries(const fs::path& path) {
  return is_stream(path) ? fs::temp_directory_path() : directory_of(path);
}

/// `.NAME` and something, beside the target.
fs::path hidden_neighbour(const fs::path& target, const std::string& ending) {
  std::string name(".");
  name += target.filename().string();
  return target.parent_path() / name.append(ending);
}

/// Removes the named temporaries of a directory whose writers are gone: they hold their locks no longer.
void remove_abandoned(const fs::path& directory) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory, ignored)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with('.') || !name.ends_with(part_ending)) continue;
    const Descriptor file(entry.path(), O_RDWR | O_CLOEXEC);
    if (file.is_open() && ::flock(file.number(), LOCK_EX | LOCK_NB) == 0) ::unlink(entry.path().c_str());
  }
}

void remove_abandoned_once(const fs::path& directory) {
  static std::mutex mutex;
  static std::set<fs::path> seen;
  const std::lock_guard lock(mutex);
  if (seen.insert(fs::absolute(directory)).second) remove_abandoned(directory);
}

/// A new, empty file on the target's file system; gone with the object, unless it was put into place.
class Temporary {
 public:
  Temporary(const fs::path& target, TemporaryFile kind) : target_(target) {
    if (kind == TemporaryFile::unnamed_where_possible) open_unnamed();
    if (!file_.is_open()) open_named();
  }
  ~Temporary() {
    if (!name_.empty()) ::unlink(name_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  fs::path path() const { return name_.empty() ? descriptor_path() : name_; }

  void flush() const {
    struct stat own, old;
    if (!name_.empty() && ::stat(name_.c_str(), &own) != 0) fail("cannot write", target_, errno);
    if (::fsync(file_.number()) != 0) fail("cannot write", target_, errno);
    if (::stat(target_.c_str(), &old) == 0 && ::fchmod(file_.number(), old.st_mode & 07777) != 0)
      fail("cannot keep the permissions of", target_, errno);
  }

  void put_into_place() {
    if (name_.empty())
      link_into_place();
    else if (::rename(name_.c_str(), target_.c_str()) != 0)
      fail("cannot replace", target_, errno);
    name_.clear();
  }

 private:
  // Where proc is mounted, this names the file to whoever opens it in this process.
  fs::path descriptor_path() const { return "/proc/self/fd/" + std::to_string(file_.number()); }

  void open_unnamed() {
    file_ = Descriptor(directory_of(target_), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
    if (file_.is_open() && ::access(descriptor_path().c_str(), W_OK) != 0) file_ = Descriptor();
  }

  void open_named() {
    static std::atomic<unsigned> counter{0};
    remove_abandoned_once(directory_of(target_));
    // Names of other processes may be in the way: their ids repeat over time and between machines that
    // share a disk. And who removes abandoned files may have been faster than the lock.
    for (int attempt = 0; attempt < max_attempts; ++attempt) {
      std::string ending(".");
      ending += std::to_string(::getpid()) + '-' + std::to_string(counter++);
      fs::path name = hidden_neighbour(target_, ending.append(part_ending));
      file_ = Descriptor(name, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
      if (!file_.is_open() && errno != EEXIST) break;
      struct stat status;
      if (!file_.is_open() || ::flock(file_.number(), LOCK_EX | LOCK_NB) != 0 ||
          ::fstat(file_.number(), &status) != 0 || status.st_nlink == 0)
        continue;
      name_ = std::move(name);
      return;
    }
    fail("cannot create a file for", target_, errno);
  }

  bool link_to(const fs::path& name) const {
    return ::linkat(AT_FDCWD, descriptor_path().c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  }

  /// A link does not replace a file, but a rename does. Whoever finds another's file between the two renames
  /// it, for it is complete; so a name that is gone was renamed.
  void link_into_place() const {
    if (link_to(target_)) return;
    const fs::path name = hidden_neighbour(target_, std::string(new_ending));
    for (int attempt = 0; errno == EEXIST && attempt < max_attempts; ++attempt) {
      const bool is_mine = link_to(name);
      if (!is_mine && errno != EEXIST) break;
      const bool renamed = ::rename(name.c_str(), target_.c_str()) == 0 || errno == ENOENT;
      if (is_mine && renamed) return;
      if (!renamed) {
        // Mine or another's, it cannot replace the target for either.
        const int error = errno;
        ::unlink(name.c_str());
        fail("cannot replace", target_, error);
      }
      errno = EEXIST;
    }
    fail("cannot replace", target_, errno);
  }

  fs::path target_;
  fs::path name_;  // empty while the file has none
  Descriptor file_;
};

/// Also of a link to what is not there yet.
fs::path followed(const fs::path& path) {
  constexpr int max_links = 40;  // as Linux follows
  fs::path target = path;
  for (int links = 0; links < max_links; ++links) {
    std::error_code error;
    if (!fs::is_symlink(fs::symlink_status(target, error))) return target;
    target = target.parent_path() / fs::read_symlink(target, error);
    if (error) fail("cannot follow", path, error.value());
  }
  fail("cannot follow", path, ELOOP);
}

/// What has not been written in full reaches no reader.
void write_into_stream(const fs::path& path, const std::function<void(const fs::path&)>& write,
                       TemporaryFile kind) {
  constexpr std::size_t block = 1 << 20;  // bytes, of which a pipe takes 64 KiB at a time
  require_writable_stream(path);
  const Temporary temporary(directory_for_temporaries(path) / path.filename(), kind);
  write(temporary.path());
  const Descriptor content(temporary.path(), O_RDONLY | O_CLOEXEC), stream(open_stream(path));
  std::string bytes(block, '\0');
  ssize_t count = 0;
  while ((count = ::read(content.number(), bytes.data(), bytes.size())) > 0)
    write_to_descriptor(stream.number(), {bytes.data(), static_cast<std::size_t>(count)}, path);
  if (count < 0) fail("cannot write", path, errno);
}

void flush_directory(const fs::path& directory) {
  const Descriptor descriptor(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // Some file systems cannot flush a directory (EINVAL), and one may be writable but not readable: the
  // rename has happened, so neither is a failure.
  if (descriptor.is_open() && ::fsync(descriptor.number()) != 0 && errno == EIO)
    fail("cannot write the directory", directory, errno);
}

// Jobs of a batch run side by side, each on a thread of its own.
thread_local HeldFiles* holder = nullptr;
thread_local LateDirectories* late_directories = nullptr;

/// Sets a pointer until the end of its life.
template <typename Pointee>
class Setting {
 public:
  Setting(Pointee*& pointer, Pointee* value) : pointer_(pointer), before_(std::exchange(pointer, value)) {}
  ~Setting() { pointer_ = before_; }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

 private:
  Pointee*& pointer_;
  Pointee* before_;
};

}  // namespace

void write_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write,
                      TemporaryFile kind) {
  if (holder) return holder->write(path, write, kind);
  if (is_stream(path)) return write_into_stream(path, write, kind);
  const fs::path target = followed(path);
  std::error_code ignored;
  if (target.filename().empty() || fs::is_directory(target, ignored)) fail("cannot write", path, EISDIR);
  Temporary temporary(target, kind);
  write(temporary.path());
  temporary.flush();
  temporary.put_into_place();
  late_directories ? late_directories->add(directory_of(target)) : flush_directory(directory_of(target));
}

void remove_written(const fs::path& path) {
  if (holder) return holder->remove(path);
  if (is_stream(path)) return;
  try {
    std::error_code ignored;
    fs::remove(followed(path), ignored);
  } catch (const FileError&) {
    // Links in a circle: nothing was written.
  }
}

fs::path directory_of_temporaries(const fs::path& path) {
  return holder ? holder->directory_ : directory_for_temporaries(path);
}

void make_directories(const fs::path& directory) {
  std::error_code error;
  fs::create_directories(directory, error);
  if (fs::is_directory(directory)) return;
  for (fs::path part = directory; !part.empty(); part = part.parent_path()) {
    std::error_code ignored;
    if (fs::exists(part, ignored) && !fs::is_directory(part, ignored))
      throw FileError(part.string() + ": is no directory but a file; name another");
    if (part == part.parent_path()) break;
  }
  throw FileError(directory.string() + ": cannot be made: " + error.message());
}

bool writes_are_held() { return holder != nullptr; }

void LateDirectories::note(const std::function<void()>& body) {
  const Setting setting(late_directories, this);
  body();
}

void LateDirectories::add(const fs::path& directory) {
  const std::lock_guard lock(mutex_);
  directories_.insert(directory);
}

void LateDirectories::flush() {
  const std::lock_guard lock(mutex_);
  for (const fs::path& directory : directories_) flush_directory(directory);
  directories_.clear();
}

struct HeldFiles::Content {
  fs::path path;
  Temporary file;
};

HeldFiles::HeldFiles(fs::path directory) : directory_(std::move(directory)) {}

HeldFiles::~HeldFiles() = default;

void HeldFiles::hold(const std::function<void()>& body) {
  const Setting setting(holder, this);
  body();
}

void HeldFiles::write(const fs::path& path, const std::function<void(const fs::path&)>& write,
                      TemporaryFile kind) {
  if (path.filename().empty()) fail("cannot write", path, EISDIR);
  std::unique_ptr<Content> content(new Content{path, {directory_ / path.filename(), kind}});
  write(content->file.path());
  remove(path);
  contents_.push_back(std::move(content));
}

void HeldFiles::remove(const fs::path& path) {
  std::erase_if(contents_, [&](const auto& content) { return content->path == path; });
}

std::vector<HeldFiles::File> HeldFiles::files() const {
  std::vector<File> files;
  for (const auto& content : contents_) files.push_back({content->path, content->file.path()});
  return files;
}

}  // namespace bespoke
