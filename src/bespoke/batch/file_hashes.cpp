#include "bespoke/batch/file_hashes.h"

#include <sys/stat.h>

#include <chrono>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

constexpr std::int64_t nanoseconds = 1'000'000'000;

// Linux stamps files with the time of its last tick, 1 to 10 ms ago.
constexpr std::int64_t tick = nanoseconds / 50;

}  // namespace

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct stat status;
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileStamp{static_cast<std::uint64_t>(status.st_size),
                   status.st_mtim.tv_sec * nanoseconds + status.st_mtim.tv_nsec};
}

bool is_within_timestamp_resolution(const FileStamp& stamp) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - stamp.modified < tick;
}

FileHashes::HashedFile FileHashes::of(const std::filesystem::path& path) {
  const std::optional<FileStamp> stamp = stamp_of(path);
  if (!stamp) throw FileError(path.string() + ": no such file");
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(path.native());
    if (known != known_.end() && known->second.stamp == *stamp) return known->second;
  }
  const bool is_recent = is_within_timestamp_resolution(*stamp);
  HashedFile read{*stamp, is_recent, sha256_of_file(path)};
  if (is_recent) return read;
  const std::lock_guard lock(mutex_);
  return known_[path.native()] = std::move(read);
}

}  // namespace bespoke
