#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/product/carry/product_file.h"

namespace bespoke {

/// Rows of bytes of one length, at equal distances in a buffer. All numbers count bytes but `count`.
struct GltfRows {
  std::size_t offset = 0;             ///< of the first row
  std::size_t stride = 0;             ///< from row to row, at least `size`
  std::size_t size = 0;               ///< of a row
  std::size_t count = 0;              ///< of rows
  std::shared_ptr<const char> bytes;  ///< of all rows, one behind the other
};

/// The bytes of a glTF buffer: those of a file, which are read when they are requested, or a string; with
/// rows in place of some of them. Copies share what they hold.
class GltfBuffer {
 public:
  explicit GltfBuffer(std::string bytes = {});
  /// Bytes of a file, which must outlive the buffer.
  GltfBuffer(const InputFile& file, std::uint64_t begin, std::size_t size)
      : file_(&file), begin_(begin), own_size_(size), size_(size) {}

  std::size_t size() const { return size_; }

  /// Reads `size` bytes from `offset` on. Throws FileError.
  void read(std::size_t offset, char* to, std::size_t size) const;
  std::string content() const;
  void write(OutputFile& output) const;

  /// Appends zeros.
  void grow(std::size_t size) { size_ = size; }
  /// Of rows with a byte in common, the later replace the earlier.
  void replace(GltfRows rows) { replaced_.push_back(std::move(rows)); }

 private:
  void read_window(std::size_t offset, char* to, std::size_t size) const;

  const InputFile* file_ = nullptr;
  std::uint64_t begin_ = 0;
  std::shared_ptr<const std::string> held_;  ///< without a file
  std::size_t own_size_ = 0, size_ = 0;      ///< of what it began with, and now
  std::vector<GltfRows> replaced_;
};

}  // namespace bespoke
