#include "bespoke/product/threemf/zip_file.h"

#include <zlib.h>

#include <algorithm>
#include <array>

#include "bespoke/error.h"
#include "bespoke/strings.h"

namespace bespoke {
namespace {

// APPNOTE.TXT, the specification of ZIP, 4.3.7 to 4.3.16: signatures and sizes of the fixed parts.
constexpr std::uint64_t entry_signature = 0x02014b50, entry_size = 46;
constexpr std::uint64_t header_signature = 0x04034b50, entry_header_size = 30;
constexpr std::uint64_t end_signature = 0x06054b50, end_size = 22, longest_comment = 0xffff;
constexpr std::uint64_t end64_signature = 0x06064b50, end64_size = 56;
constexpr std::uint64_t locator_signature = 0x07064b50, locator_size = 20;
constexpr std::uint64_t wide_extra = 1;  // the extra field with the numbers that take 64 bits
constexpr std::uint64_t in_wide_extra = 0xffffffff;

constexpr int is_stored = 0, is_deflated = 8;
constexpr std::uint64_t max_expansion = 200;
constexpr std::size_t piece_size = std::size_t{1} << 18;

/// The little-endian number of these bytes.
std::uint64_t number(std::string_view bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

/// Puts the wide numbers of an entry in the place of those that do not fit in theirs; false where they are
/// missing.
bool widen(std::string_view extra, ZipEntry& entry) {
  const std::array<std::uint64_t*, 3> fields{&entry.size, &entry.stored_size, &entry.header};
  const auto is_wide = [](const std::uint64_t* field) { return *field == in_wide_extra; };
  if (std::none_of(fields.begin(), fields.end(), is_wide)) return true;
  while (extra.size() >= 4) {
    const std::uint64_t length = number(extra, 2, 2);
    if (length > extra.size() - 4) return false;
    std::string_view content = extra.substr(4, length);
    if (number(extra, 0, 2) == wide_extra) {
      for (std::uint64_t* const field : fields) {
        if (!is_wide(field)) continue;
        if (content.size() < 8) return false;
        *field = number(content, 0, 8);
        content.remove_prefix(8);
      }
      return true;
    }
    extra.remove_prefix(4 + length);
  }
  return false;
}

/// zlib's state, of deflated bytes without a header of zlib's own.
class Inflater {
 public:
  Inflater() { good_ = inflateInit2(&stream_, -MAX_WBITS) == Z_OK; }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  void feed(std::string& bytes) {
    stream_.next_in = reinterpret_cast<Bytef*>(bytes.data());
    stream_.avail_in = static_cast<uInt>(bytes.size());
  }
  bool wants_more() const { return stream_.avail_in == 0; }
  bool has_ended() const { return ended_; }

  /// The next bytes, into the given buffer; false for damage.
  bool next(std::string& room, std::string_view& piece) {
    stream_.next_out = reinterpret_cast<Bytef*>(room.data());
    stream_.avail_out = static_cast<uInt>(room.size());
    const int result = good_ ? inflate(&stream_, Z_NO_FLUSH) : Z_STREAM_ERROR;
    piece = std::string_view(room.data(), room.size() - stream_.avail_out);
    ended_ = result == Z_STREAM_END;
    return result == Z_OK || result == Z_STREAM_END || (result == Z_BUF_ERROR && wants_more());
  }

 private:
  z_stream stream_{};
  bool good_ = false, ended_ = false;
};

}  // namespace

ZipFile::ZipFile(const InputFile& file) : file_(file) {
  const Directory directory = find_directory();
  if (directory.size > file.size() || directory.offset > file.size() - directory.size)
    fail("the archive's directory lies outside of the file");
  const std::string all = bytes(directory.offset, directory.size);
  std::string_view rest = all;
  for (std::uint64_t i = 0; i < directory.entries; ++i) {
    if (rest.size() < entry_size || number(rest, 0, 4) != entry_signature)
      fail("the archive's directory ends before its entry " + std::to_string(i));
    const std::size_t name = number(rest, 28, 2), extra = number(rest, 30, 2), comment = number(rest, 32, 2);
    if (rest.size() - entry_size < name + extra + comment)
      fail("entry " + std::to_string(i) + " of the archive's directory is cut off");
    ZipEntry entry;
    entry.name = rest.substr(entry_size, name);
    entry.encrypted = (number(rest, 8, 2) & 1) != 0;
    entry.method = static_cast<int>(number(rest, 10, 2));
    entry.checksum = static_cast<std::uint32_t>(number(rest, 16, 4));
    entry.stored_size = number(rest, 20, 4);
    entry.size = number(rest, 24, 4);
    entry.header = number(rest, 42, 4);
    if (!widen(rest.substr(entry_size + name, extra), entry))
      fail("entry " + std::to_string(i) + " of the archive's directory lacks its 64-bit sizes");
    entries_.push_back(std::move(entry));
    rest.remove_prefix(entry_size + name + extra + comment);
  }
}

ZipFile::Directory ZipFile::find_directory() const {
  const std::uint64_t tail_size = std::min(file_.size(), end_size + longest_comment);
  const std::string tail = bytes(file_.size() - tail_size, tail_size);
  for (std::size_t at = tail.size() - std::min<std::size_t>(tail.size(), end_size) + 1; at-- > 0;) {
    if (tail.size() - at < end_size || number(tail, at, 4) != end_signature) continue;
    if (number(tail, at + 20, 2) != tail.size() - at - end_size) continue;  // a comment up to the end
    const Directory narrow{number(tail, at + 10, 2), number(tail, at + 12, 4), number(tail, at + 16, 4)};
    const bool is_wide =
        narrow.entries == 0xffff || narrow.size == in_wide_extra || narrow.offset == in_wide_extra;
    if (!is_wide || at < locator_size || number(tail, at - locator_size, 4) != locator_signature)
      return narrow;
    const std::uint64_t wide = number(tail, at - locator_size + 8, 8);
    if (file_.size() < end64_size || wide > file_.size() - end64_size) break;
    const std::string end = bytes(wide, end64_size);
    if (number(end, 0, 4) != end64_signature) break;
    return {number(end, 32, 8), number(end, 40, 8), number(end, 48, 8)};
  }
  fail("is no ZIP archive, or cut off: its directory is missing");
}

const ZipEntry* ZipFile::find(std::string_view name) const {
  const auto at = std::find_if(
      entries_.begin(), entries_.end(),
      [wanted = lower_case(name)](const ZipEntry& entry) { return lower_case(entry.name) == wanted; });
  return at == entries_.end() ? nullptr : &*at;
}

std::uint64_t ZipFile::data_of(const ZipEntry& entry) const {
  if (file_.size() < entry_header_size || entry.header > file_.size() - entry_header_size)
    fail(entry.name + " lies outside of the file");
  const std::string header = bytes(entry.header, entry_header_size);
  if (number(header, 0, 4) != header_signature) fail(entry.name + " is not where the directory says");
  const std::uint64_t data = entry.header + entry_header_size + number(header, 26, 2) + number(header, 28, 2);
  if (data > file_.size() || entry.stored_size > file_.size() - data) fail(entry.name + " is cut off");
  return data;
}

void ZipFile::read(const ZipEntry& entry, const std::function<bool(std::string_view piece)>& take) const {
  if (entry.encrypted) fail(entry.name + " is encrypted");
  if (entry.method != is_stored && entry.method != is_deflated)
    fail(entry.name + " is compressed by method " + std::to_string(entry.method) +
         "; only deflate (8) is read");
  if (entry.size / max_expansion > entry.stored_size)
    fail(entry.name + " would expand to " + std::to_string(entry.size) + " bytes from " +
         std::to_string(entry.stored_size) + ", which no list of numbers does");
  const std::uint64_t data = data_of(entry);
  std::uint64_t fed = 0, total = 0;
  uLong checksum = crc32(0, nullptr, 0);
  Inflater inflater;
  std::string stored, room(piece_size, '\0');
  while (entry.method == is_stored ? fed < entry.stored_size : !inflater.has_ended()) {
    std::string_view piece;
    if (entry.method == is_stored || inflater.wants_more()) {
      if (fed == entry.stored_size) fail(entry.name + " ends too early");
      stored = bytes(data + fed, std::min<std::uint64_t>(piece_size, entry.stored_size - fed));
      fed += stored.size();
      piece = stored;
      inflater.feed(stored);
    }
    if (entry.method == is_deflated && !inflater.next(room, piece)) fail(entry.name + " is damaged");
    total += piece.size();
    if (total > entry.size) fail(entry.name + " is longer than the directory says");
    checksum = crc32(checksum, reinterpret_cast<const Bytef*>(piece.data()), static_cast<uInt>(piece.size()));
    if (!piece.empty() && !take(piece)) return;
  }
  if (total != entry.size || checksum != entry.checksum)
    fail(entry.name + " is damaged: its checksum differs");
}

std::string ZipFile::bytes(std::uint64_t offset, std::uint64_t size) const {
  std::string result(size, '\0');
  file_.read(offset, result.data(), result.size());
  return result;
}

void ZipFile::fail(const std::string& what) const { throw FormatError(file_.path().string() + ": " + what); }

}  // namespace bespoke
