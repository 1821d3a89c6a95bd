#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/batch/detail/random_access_file.h"

namespace bespoke {

/// The tar format of POSIX (ustar with pax headers): members of a header of 512 bytes and content padded to
/// blocks of as many. Written here because archives must grow and be cut at whole members, and hold comments:
/// libarchive has calls for none of these.
struct TarMember {
  enum class Kind { file, comment, other };

  Kind kind = Kind::other;
  std::string name;
  std::string comment;        ///< of a pax header that concerns no member
  std::uint64_t begin = 0;    ///< of its first header, bytes from the archive's beginning
  std::uint64_t content = 0;  ///< where that begins
  std::uint64_t bytes = 0;    ///< of content
  std::uint64_t end = 0;      ///< behind the padding
};

/// What comes before the content of a file, readable for all and writable for its owner. `modified` is in
/// seconds since 1970.
std::string tar_header(const std::string& name, std::uint64_t bytes, std::int64_t modified);

/// What comes behind the content.
std::string tar_padding(std::uint64_t bytes);

/// A member that holds a text for programs that know it; others read past it.
std::string tar_comment(const std::string& text);

/// What ends an archive: two blocks of zeros.
std::string tar_end();

/// The members of a tar file, from its beginning.
class TarReader {
 public:
  explicit TarReader(const RandomAccessFile& file) : file_(file), bytes_(file.size()) {}

  /// Empty at the end of the archive, and where no whole member follows. Throws FileError.
  std::optional<TarMember> next();

  /// Whether what follows the last member is an archive's end and nothing behind it.
  bool is_ended() const { return ended_; }

 private:
  struct Header;

  std::optional<Header> read_header(std::uint64_t offset);
  std::string read(std::uint64_t offset, std::uint64_t bytes);

  const RandomAccessFile& file_;
  std::uint64_t bytes_;
  std::uint64_t offset_ = 0;  // of the next member
  std::string window_;        // what was read last
  std::uint64_t window_begin_ = 0;
  bool ended_ = false;
};

}  // namespace bespoke
