#include "bespoke/output_stream.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <optional>
#include <string>

#include "bespoke/error.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

constexpr int max_links = 40;        // as Linux follows
constexpr int first_descriptor = 3;  // behind the standard ones

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw FileError("cannot write " + path.string() + ": " + why);
}

std::optional<int> open_descriptor(const std::string& digits) {
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool is_number = error == std::errc() && end == digits.data() + digits.size();
  return is_number && ::fcntl(number, F_GETFD) >= 0 ? std::optional(number) : std::nullopt;
}

/// Of this process, where the path is or links to /proc/self/fd/N. Opening such a path again would lose the
/// place in the file that the shell redirects to, and fails for sockets.
std::optional<int> own_descriptor(fs::path path) {
  std::error_code error;
  const fs::path descriptors = fs::canonical("/proc/self/fd", error);
  for (int links = 0; !error && links < max_links; ++links) {
    const fs::path directory = fs::canonical(path.has_parent_path() ? path.parent_path() : ".", error);
    if (error) break;
    if (directory == descriptors) return open_descriptor(path.filename().string());
    path = directory / fs::read_symlink(directory / path.filename(), error);
  }
  return std::nullopt;
}

/// What the path leads to; 0 where nothing is.
mode_t kind_of(const fs::path& path) {
  struct stat status;
  return ::stat(path.c_str(), &status) == 0 ? status.st_mode & S_IFMT : 0;
}

}  // namespace

bool is_stream(const fs::path& path) {
  const mode_t kind = kind_of(path);
  if (kind == S_IFDIR) return false;
  return (kind != 0 && kind != S_IFREG) || own_descriptor(path);
}

void require_writable_stream(const fs::path& path) {
  if (own_descriptor(path)) return;
  const mode_t kind = kind_of(path);
  if (kind == S_IFBLK) fail(path, "it is a block device, whose content would be lost; name a file");
  if (kind == S_IFSOCK) fail(path, "it is a socket, which cannot be opened; name a file or a pipe");
}

int open_stream(const fs::path& path) {
  require_writable_stream(path);
  const std::optional<int> own = own_descriptor(path);
  const int descriptor = own ? ::fcntl(*own, F_DUPFD_CLOEXEC, first_descriptor)
                             : ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY);
  if (descriptor >= 0) return descriptor;
  if (errno == EINTR) throw Interrupted("interrupted while " + path.string() + " had no reader");
  fail(path, std::strerror(errno));
}

void write_to_descriptor(int descriptor, std::string_view bytes, const fs::path& name) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {
      pollfd ready{descriptor, POLLOUT, 0};
      ::poll(&ready, 1, -1);
    } else if (errno != EINTR) {
      fail(name, errno == EPIPE ? "its reader has gone" : std::strerror(errno));
    }
  }
}

}  // namespace bespoke
