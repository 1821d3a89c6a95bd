#include "bespoke/product/carry/product_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include "bespoke/atomic_file.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const char* what, const fs::path& path, const char* why) {
  throw FileError(std::string(what) + " " + path.string() + ": " + why);
}

/// Gone with its descriptor.
int open_unnamed(const fs::path& directory) {
  const int descriptor = ::open(directory.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, S_IRUSR | S_IWUSR);
  if (descriptor >= 0) return descriptor;
  // A file system that knows no files without a name.
  std::string name = (directory / ".bespoke-XXXXXX").string();
  const int named = ::mkostemp(name.data(), O_CLOEXEC);
  if (named < 0) fail("cannot write into", directory, std::strerror(errno));
  ::unlink(name.c_str());
  return named;
}

void write_from(const std::vector<fs::path>& paths, std::vector<OutputFile>& open,
                const std::function<void(std::vector<OutputFile>&)>& write) {
  if (open.size() == paths.size()) {
    write(open);
    open.clear();
    return;
  }
  const fs::path& path = paths[open.size()];
  write_atomically(path, [&](const fs::path& temporary) {
    open.emplace_back(temporary, path);
    write_from(paths, open, write);
  });
}

}  // namespace

InputFile::InputFile(fs::path path)
    : InputFile(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK), path) {}

InputFile::InputFile(int descriptor, fs::path name) : path_(std::move(name)), descriptor_(descriptor) {
  if (descriptor_ < 0) fail("cannot read", path_, std::strerror(errno));
  struct stat status;
  const int result = ::fstat(descriptor_, &status);
  if (result == 0 && S_ISREG(status.st_mode) && status.st_size > 0) {
    size_ = static_cast<std::uint64_t>(status.st_size);
    ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);
    return;
  }
  const int error = errno;
  ::close(descriptor_);
  if (result != 0) fail("cannot read", path_, std::strerror(error));
  if (!S_ISREG(status.st_mode)) fail("cannot read", path_, "not a regular file");
  throw FormatError(path_.string() + ": the file is empty");
}

InputFile::~InputFile() { ::close(descriptor_); }

void InputFile::read(std::uint64_t offset, char* to, std::size_t size) const {
  while (size > 0) {
    const ssize_t count = ::pread(descriptor_, to, size, static_cast<off_t>(offset));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot read", path_, std::strerror(errno));
    if (count == 0) fail("cannot read", path_, "it has become shorter while it was read");
    to += count;
    offset += static_cast<std::uint64_t>(count);
    size -= static_cast<std::size_t>(count);
  }
}

std::string InputFile::content() const {
  std::string bytes(size_, '\0');
  read(0, bytes.data(), bytes.size());
  return bytes;
}

std::unique_ptr<InputFile> InputFile::of_written(const fs::path& directory, fs::path name,
                                                 const std::function<void(OutputFile&)>& write) {
  OutputFile output(open_unnamed(directory.empty() ? "." : directory), name);
  write(output);
  return std::unique_ptr<InputFile>(new InputFile(std::exchange(output.descriptor_, -1), std::move(name)));
}

OutputFile::OutputFile(const fs::path& path, fs::path name)
    : name_(std::move(name)), descriptor_(::open(path.c_str(), O_WRONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) fail("cannot write", name_, std::strerror(errno));
}

OutputFile::~OutputFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : name_(std::move(other.name_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

OutputFile& OutputFile::operator=(OutputFile&& other) noexcept {
  std::swap(name_, other.name_);
  std::swap(descriptor_, other.descriptor_);
  return *this;
}

void OutputFile::write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail("cannot write", name_, std::strerror(errno));
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

void write_outputs(const std::vector<fs::path>& paths,
                   const std::function<void(std::vector<OutputFile>&)>& write) {
  std::vector<OutputFile> open;
  open.reserve(paths.size());
  write_from(paths, open, write);
}

}  // namespace bespoke
