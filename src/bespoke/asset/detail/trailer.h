#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace bespoke {

/// The two parts of an asset's file, before the trailer.
struct AssetSections {
  std::string_view vdb;
  std::string_view exact_map;  ///< empty without `--keep-exact`
};

/// How a trailer vouches for the sections: by the number that it stores as its version.
enum class TrailerForm {
  one_hash = 1,  ///< SHA-256 of all before it, so that whoever reads a byte reads them all
  block_hashes =
      2,  ///< before it comes the SHA-256 of every block of the sections, so that parts can be read
};

/// Bytes of the trailer that ends every asset: 8 magic, 4 version, 4 bytes in a block (0 in form 1), 8 length
/// of the VDB part, 8 length of the exact map, 32 SHA-256 of all before it (form 2: of the blocks' hashes and
/// what stands in the trailer before it), little-endian. OpenVDB ignores what follows the last grid.
inline constexpr std::size_t trailer_size = 64;
inline constexpr std::size_t digest_size = 32;

/// Bytes of the sections from which on a file that is written here has hashes of blocks. Programs older than
/// that form refuse it, and smaller ones gain little by it: README.md has 0.2 s for all of a file of 22 MB.
inline constexpr std::uint64_t block_hashes_from = std::uint64_t{1} << 26;

TrailerForm form_for(std::uint64_t content_size);

/// Bytes of a block of a file that is written here: some 20 leaves. Larger blocks read more than a product
/// needs, smaller ones have more hashes. Other sizes are read as well.
inline constexpr std::size_t block_size = std::size_t{1} << 16;

/// What a trailer says.
struct Trailer {
  TrailerForm form = TrailerForm::one_hash;
  std::size_t block_size = 0;  ///< bytes; 0 in form 1
  std::uint64_t vdb_size = 0;
  std::uint64_t exact_size = 0;
  std::string digest;  ///< 64 hexadecimal digits

  std::uint64_t content_size() const { return vdb_size + exact_size; }
  std::uint64_t block_count() const;  ///< the last may be shorter
  std::uint64_t table_size() const { return digest_size * block_count(); }
};

/// `last` are the last trailer_size bytes of a file of `file_size`. Throws FormatError unless they are a
/// trailer whose lengths are those of the file.
Trailer parse_trailer(std::string_view last, std::uint64_t file_size);

/// Form 2: throws FormatError unless the trailer's hash is that of the table and of the trailer before it.
void require_sound_table(std::string_view table, std::string_view last, const Trailer& trailer);

/// Form 2: throws FormatError, naming the offset, unless `bytes` have the hash that the table has for them.
void require_sound_block(std::string_view bytes, std::uint64_t block, std::string_view table,
                         const Trailer& trailer);

/// `sections` and their trailer.
std::string seal(const AssetSections& sections, TrailerForm form = TrailerForm::one_hash);

/// The sections of a file whose trailer fits it, in either form; views into `bytes`. Throws FormatError.
AssetSections unseal(std::string_view bytes);

}  // namespace bespoke
