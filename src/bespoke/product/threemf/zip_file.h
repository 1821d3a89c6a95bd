#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "bespoke/product/carry/product_file.h"

namespace bespoke {

/// A file in a ZIP archive.
struct ZipEntry {
  std::string name;
  std::uint64_t index = 0;        ///< in the archive's directory
  std::uint64_t stored_size = 0;  ///< bytes in the archive
  std::uint64_t size = 0;         ///< bytes inflated
};

/// Reads ZIP archives (libzip). One thread at a time.
class ZipFile {
 public:
  /// Reads the directory. Throws FormatError for what is no archive, or cut off.
  explicit ZipFile(const InputFile& file);
  ~ZipFile();

  const std::filesystem::path& path() const { return path_; }

  /// By its name, whatever the case of its ASCII letters.
  std::optional<ZipEntry> find(const std::string& name) const;

  /// Inflates in pieces, until the end or until `take` returns false. Throws FormatError naming the entry for
  /// an encrypted or unknown form, damage of any kind, and one that says that it expands by more than 200
  /// times: no list of numbers does.
  void read(const ZipEntry& entry, const std::function<bool(std::string_view piece)>& take) const;

 private:
  struct Archive;

  [[noreturn]] void fail(const std::string& what) const;

  std::filesystem::path path_;
  std::unique_ptr<Archive> archive_;
};

}  // namespace bespoke
