#include "bespoke/asset/detail/block_file.h"

#include <algorithm>

#include "bespoke/error.h"

namespace bespoke {

std::optional<BlockFile> BlockFile::open(const std::filesystem::path& path) {
  BlockFile file;
  file.name_ = path.string();
  // Without a buffer of its own, which would read ahead.
  file.stream_.rdbuf()->pubsetbuf(nullptr, 0);
  file.stream_.open(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file.stream_.tellg();
  if (!file.stream_ || size < 0) throw FileError(path.string() + ": cannot be opened for reading");
  file.file_size_ = static_cast<std::uint64_t>(size);
  const std::uint64_t last_size = std::min<std::uint64_t>(file.file_size_, trailer_size);
  const std::string last = file.bytes_at(file.file_size_ - last_size, last_size);
  file.trailer_ = parse_trailer(last, file.file_size_);
  if (file.trailer_.form == TrailerForm::one_hash) return std::nullopt;
  file.table_ = file.bytes_at(file.trailer_.content_size(), file.trailer_.table_size());
  require_sound_table(file.table_, last, file.trailer_);
  return file;
}

std::string BlockFile::bytes_at(std::uint64_t offset, std::uint64_t size) {
  std::string bytes(size, '\0');
  stream_.seekg(static_cast<std::streamoff>(offset));
  if (!stream_.read(bytes.data(), static_cast<std::streamsize>(size)))
    throw FileError(name_ + ": cannot be read at byte " + std::to_string(offset));
  bytes_read_ += size;
  return bytes;
}

std::string BlockFile::block(std::uint64_t number) {
  const std::uint64_t offset = number * trailer_.block_size;
  std::string bytes =
      bytes_at(offset, std::min<std::uint64_t>(trailer_.block_size, trailer_.content_size() - offset));
  require_sound_block(bytes, number, table_, trailer_);
  return bytes;
}

BlockBuffer::int_type BlockBuffer::underflow() {
  const auto end = static_cast<off_type>(file_.trailer().vdb_size);
  const auto size = static_cast<off_type>(file_.trailer().block_size);
  const off_type at = position();
  if (at >= end) return traits_type::eof();
  const off_type begin = at / size * size;
  bytes_ = file_.block(static_cast<std::uint64_t>(begin / size));
  // The last block may go on with the exact map, which is none of the reader's business.
  const off_type last = std::min(static_cast<off_type>(bytes_.size()), end - begin);
  base_ = begin;
  setg(bytes_.data(), bytes_.data() + (at - begin), bytes_.data() + last);
  return traits_type::to_int_type(*gptr());
}

BlockBuffer::pos_type BlockBuffer::seekoff(off_type offset, std::ios_base::seekdir direction,
                                           std::ios_base::openmode) {
  const auto end = static_cast<off_type>(file_.trailer().vdb_size);
  const off_type from = direction == std::ios_base::beg   ? 0
                        : direction == std::ios_base::cur ? position()
                                                          : end;
  if (offset < -from || offset > end - from) return pos_type(off_type(-1));
  const off_type to = from + offset;
  if (to >= base_ && to <= base_ + (egptr() - eback())) {
    setg(eback(), eback() + (to - base_), egptr());
  } else {
    base_ = to;
    setg(nullptr, nullptr, nullptr);  // the block is read when a byte of it is
  }
  return pos_type(to);
}

BlockBuffer::pos_type BlockBuffer::seekpos(pos_type position, std::ios_base::openmode mode) {
  return seekoff(off_type(position), std::ios_base::beg, mode);
}

}  // namespace bespoke
