#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <streambuf>
#include <string>
#include <vector>

#include "bespoke/asset/detail/trailer.h"

namespace bespoke {

/// A file whose trailer has a hash a block: hands out no byte whose block has not been verified. Not
/// thread-safe.
class BlockFile {
 public:
  /// Reads trailer and table; nothing for a file whose trailer has one hash for all. Throws FileError where
  /// it cannot be read, FormatError where the trailer does not fit it.
  static std::optional<BlockFile> open(const std::filesystem::path& path);

  const Trailer& trailer() const { return trailer_; }
  std::uint64_t file_size() const { return file_size_; }

  /// The bytes of a block. Throws FormatError, naming its offset, where they do not have its hash.
  std::string block(std::uint64_t number);

  /// Read so far: trailer, table and the blocks, each as often as it was requested.
  std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  BlockFile() = default;
  std::string bytes_at(std::uint64_t offset, std::uint64_t size);

  std::string name_;
  std::ifstream stream_;
  std::uint64_t file_size_ = 0;
  std::uint64_t bytes_read_ = 0;
  Trailer trailer_;
  std::string table_;
};

/// The VDB part of such a file, to be read and sought in. `file` must outlive it. What BlockFile::block
/// throws reaches the reader through a stream that throws on badbit.
class BlockBuffer : public std::streambuf {
 public:
  explicit BlockBuffer(BlockFile& file) : file_(file) {}

 protected:
  int_type underflow() override;
  pos_type seekoff(off_type offset, std::ios_base::seekdir direction, std::ios_base::openmode mode) override;
  pos_type seekpos(pos_type position, std::ios_base::openmode mode) override;

 private:
  off_type position() const { return base_ + (gptr() - eback()); }

  BlockFile& file_;
  std::string bytes_;  // of the block that the get area shows, if any
  off_type base_ = 0;  // where the get area begins in the file
};

}  // namespace bespoke
