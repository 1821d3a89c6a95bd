#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "bespoke/product/carry/product_file.h"

namespace bespoke {

/// A file in a ZIP archive, as the archive's directory describes it.
struct ZipEntry {
  std::string name;
  int method = 0;
  bool encrypted = false;
  std::uint32_t checksum = 0;
  std::uint64_t stored_size = 0;  ///< bytes in the archive
  std::uint64_t size = 0;         ///< bytes inflated
  std::uint64_t header = 0;       ///< where its own header begins
};

/// Reads ZIP archives, also those of the 64-bit format, of one volume.
class ZipFile {
 public:
  /// Reads the directory; the file must outlive it. Throws FormatError for what is no archive, or cut off.
  explicit ZipFile(const InputFile& file);

  const std::filesystem::path& path() const { return file_.path(); }

  /// By its name, whatever the case of its ASCII letters; null when there is none.
  const ZipEntry* find(std::string_view name) const;

  /// Inflates in pieces, until the end or until `take` returns false. Throws FormatError naming the entry for
  /// an encrypted or unknown form, damage of any kind, and one that says that it expands by more than 200
  /// times: no list of numbers does.
  void read(const ZipEntry& entry, const std::function<bool(std::string_view piece)>& take) const;

 private:
  struct Directory {
    std::uint64_t entries, size, offset;
  };
  Directory find_directory() const;
  std::uint64_t data_of(const ZipEntry& entry) const;
  std::string bytes(std::uint64_t offset, std::uint64_t size) const;
  [[noreturn]] void fail(const std::string& what) const;

  const InputFile& file_;
  std::vector<ZipEntry> entries_;
};

}  // namespace bespoke
