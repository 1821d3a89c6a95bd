#include "bespoke/batch/file_hashes.h"

#include <sys/stat.h>

#include <chrono>
#include <fstream>
#include <memory>

#include "bespoke/error.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

constexpr std::int64_t nanoseconds = 1'000'000'000;

// Linux stamps files with the time of its last tick, 1 to 10 ms ago.
constexpr std::int64_t tick = nanoseconds / 50;

constexpr std::streamsize block_bytes = 1 << 18;

std::string hash_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const auto block = std::make_unique_for_overwrite<char[]>(block_bytes);
  Sha256 hash;
  while (file) {
    file.read(block.get(), block_bytes);
    hash.update(block.get(), static_cast<std::size_t>(file.gcount()));
  }
  if (!file.eof()) throw FileError(path.string() + ": cannot be read");
  return hash.finish();
}

}  // namespace

std::optional<FileStamp> stamp_of(const std::filesystem::path& path) {
  struct stat status;
  if (::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  return FileStamp{static_cast<std::uint64_t>(status.st_size),
                   status.st_mtim.tv_sec * nanoseconds + status.st_mtim.tv_nsec};
}

bool is_too_fresh(const FileStamp& stamp) {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return std::chrono::duration_cast<std::chrono::nanoseconds>(now).count() - stamp.modified < tick;
}

std::string FileHashes::of(const std::filesystem::path& path) {
  const std::optional<FileStamp> stamp = stamp_of(path);
  if (!stamp) throw FileError(path.string() + ": no such file");
  {
    const std::lock_guard lock(mutex_);
    const auto known = known_.find(path);
    if (known != known_.end() && known->second.stamp == *stamp) return known->second.hash;
  }
  std::string hash = hash_of(path);
  if (is_too_fresh(*stamp)) return hash;
  const std::lock_guard lock(mutex_);
  known_[path] = {*stamp, hash};
  return hash;
}

}  // namespace bespoke
