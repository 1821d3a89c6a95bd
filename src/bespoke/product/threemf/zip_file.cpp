#include "bespoke/product/threemf/zip_file.h"

#include <zip.h>

#include "bespoke/error.h"

namespace bespoke {
namespace {

constexpr std::uint64_t max_expansion = 200;
constexpr std::size_t piece_size = std::size_t{1} << 18;

std::string text_of(zip_error_t* error) {
  std::string text = zip_error_strerror(error);
  zip_error_fini(error);
  return text;
}

}  // namespace

struct ZipFile::Archive {
  explicit Archive(zip_t* opened) : zip(opened) {}
  ~Archive() { zip_discard(zip); }
  Archive(const Archive&) = delete;
  Archive& operator=(const Archive&) = delete;

  zip_t* zip;
};

ZipFile::ZipFile(const InputFile& file) : path_(file.path()) {
  int code = 0;
  zip_t* const opened = zip_open(path_.c_str(), ZIP_RDONLY, &code);
  if (!opened) {
    zip_error_t error;
    zip_error_init_with_code(&error, code);
    fail("is no ZIP archive, or cut off: " + text_of(&error));
  }
  archive_ = std::make_unique<Archive>(opened);
}

ZipFile::~ZipFile() = default;

std::optional<ZipEntry> ZipFile::find(const std::string& name) const {
  const zip_int64_t index = zip_name_locate(archive_->zip, name.c_str(), ZIP_FL_NOCASE);
  zip_stat_t entry;
  if (index < 0) return std::nullopt;
  if (zip_stat_index(archive_->zip, static_cast<zip_uint64_t>(index), 0, &entry) != 0)
    fail(name + ": " + zip_strerror(archive_->zip));
  return ZipEntry{entry.name, entry.index, entry.comp_size, entry.size};
}

void ZipFile::read(const ZipEntry& entry, const std::function<bool(std::string_view piece)>& take) const {
  if (entry.size / max_expansion > entry.stored_size)
    fail(entry.name + " would expand to " + std::to_string(entry.size) + " bytes from " +
         std::to_string(entry.stored_size) + ", which no list of numbers does");
  const std::unique_ptr<zip_file_t, decltype(&zip_fclose)> content(
      zip_fopen_index(archive_->zip, entry.index, 0), &zip_fclose);
  if (!content) fail(entry.name + " cannot be read: " + zip_strerror(archive_->zip));
  std::string piece(piece_size, '\0');
  std::uint64_t total = 0;
  for (;;) {
    const zip_int64_t bytes = zip_fread(content.get(), piece.data(), piece.size());
    if (bytes < 0) fail(entry.name + " is damaged: " + zip_file_strerror(content.get()));
    if (bytes == 0) break;
    total += static_cast<std::uint64_t>(bytes);
    if (total > entry.size) fail(entry.name + " is longer than the directory says");
    if (!take(std::string_view(piece).substr(0, static_cast<std::size_t>(bytes)))) return;
  }
  if (total != entry.size) fail(entry.name + " is damaged: it ends too early");
}

void ZipFile::fail(const std::string& what) const { throw FormatError(path_.string() + ": " + what); }

}  // namespace bespoke
