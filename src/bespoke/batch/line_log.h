#pragma once

#include <filesystem>
#include <string>

namespace bespoke {

/// A file that grows by whole lines, also where several processes append to it.
class LineLog {
 public:
  /// Makes the file where it is not there. Throws FileError.
  explicit LineLog(std::filesystem::path path);
  ~LineLog();
  LineLog(const LineLog&) = delete;
  LineLog& operator=(const LineLog&) = delete;

  /// One call of the system a line; not flushed to the disk. Thread-safe. Throws FileError.
  void append(const std::string& line);

 private:
  std::filesystem::path path_;
  int descriptor_;
};

}  // namespace bespoke
