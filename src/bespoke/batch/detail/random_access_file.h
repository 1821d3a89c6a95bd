#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace bespoke {

/// A file that is read and written at any place.
class RandomAccessFile {
 public:
  enum class Access {
    read,
    write_alone,  ///< and read; made where it is not there; locked against others until the object is gone
    write,        ///< of a file that exists and that no other process has open
  };

  /// Throws FileError, also when the path is no regular file, or when another process has it locked.
  RandomAccessFile(const std::filesystem::path& path, Access access) : RandomAccessFile(path, access, path) {}
  /// Messages call it `name`.
  RandomAccessFile(const std::filesystem::path& path, Access access, std::filesystem::path name);
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  /// Bytes. These and all below throw FileError.
  std::uint64_t size() const;
  /// Fewer than requested at the end of the file.
  std::string read(std::uint64_t offset, std::uint64_t bytes) const;
  void write(std::uint64_t offset, std::string_view bytes);
  /// Cuts off what lies behind.
  void cut(std::uint64_t size);
  void flush();

 private:
  explicit RandomAccessFile(std::filesystem::path name) : name_(std::move(name)) {}
  void open(const std::filesystem::path& path, int flags);
  void open_alone(const std::filesystem::path& path);
  [[noreturn]] void fail(const char* what) const;

  std::filesystem::path name_;
  int descriptor_ = -1;
};

}  // namespace bespoke
