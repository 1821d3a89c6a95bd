#pragma once

#include <cstdint>
#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

namespace bespoke {

/// What the file system says of a file without reading it.
struct FileStamp {
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;  ///< nanoseconds since 1970

  bool operator==(const FileStamp&) const = default;
};

/// Empty when there is no such file.
std::optional<FileStamp> stamp_of(const std::filesystem::path& path);

/// Whether a file with this stamp may change without getting another one, because it changed just now: file
/// systems tick in some milliseconds.
bool is_within_timestamp_resolution(const FileStamp& stamp);

/// SHA-256 of files, each read once as long as its stamp stays. Thread-safe.
class FileHashes {
 public:
  struct HashedFile {
    FileStamp stamp;  ///< as it was before the file was read
    bool was_recent;  ///< is_within_timestamp_resolution then: the stamp proves nothing
    std::string hash;
  };

  /// Throws FileError when the file cannot be read.
  HashedFile of(const std::filesystem::path& path);

 private:
  std::mutex mutex_;
  std::unordered_map<std::string, HashedFile> known_;
};

}  // namespace bespoke
