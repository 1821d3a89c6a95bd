#include "bespoke/asset/detail/trailer.h"

#include <algorithm>
#include <atomic>

#include "bespoke/asset/detail/require_format.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

constexpr std::string_view magic("BESPOKE\n", 8);
constexpr std::size_t digest_offset = trailer_size - digest_size;

// Of a block. A smaller one would have a table as long as itself, a larger one is no part of a file.
constexpr std::uint64_t min_block = 1 << 10;
constexpr std::uint64_t largest_block = 1 << 26;

void append_little_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

constexpr int digit_value(char digit) { return digit <= '9' ? digit - '0' : digit - 'a' + 10; }

void append_digest(std::string& bytes, const std::string& hex) {
  for (std::size_t i = 0; i < hex.size(); i += 2)
    bytes.push_back(static_cast<char>(digit_value(hex[i]) << 4 | digit_value(hex[i + 1])));
}

std::string hex(std::string_view bytes) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  for (const char byte : bytes) {
    text.push_back(digits[static_cast<unsigned char>(byte) >> 4]);
    text.push_back(digits[static_cast<unsigned char>(byte) & 15]);
  }
  return text;
}

TrailerForm form_of(std::uint64_t version) {
  require_format(version == 1 || version == 2,
                 "trailer version " + std::to_string(version) + "; this program reads versions 1 and 2");
  return version == 1 ? TrailerForm::one_hash : TrailerForm::block_hashes;
}

/// The hashes of the blocks of `content`, one after the other.
std::string table_of(std::string_view content) {
  std::string table(digest_size * ((content.size() + block_size - 1) / block_size), '\0');
  parallel_for(table.size() / digest_size, 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t block = begin; block < end; ++block) {
      const std::string_view bytes = content.substr(block * block_size, block_size);
      std::string digest;
      append_digest(digest, sha256(bytes.data(), bytes.size()));
      digest.copy(table.data() + digest_size * block, digest_size);
    }
  });
  return table;
}

bool is_sound(std::string_view bytes, std::uint64_t block, std::string_view table) {
  return sha256(bytes.data(), bytes.size()) == hex(table.substr(digest_size * block, digest_size));
}

/// Names the first, whichever thread meets one first.
void require_sound_blocks(std::string_view content, std::string_view table, const Trailer& trailer) {
  std::atomic<std::uint64_t> first_bad = trailer.block_count();
  const auto block_of = [&](std::uint64_t block) {
    return content.substr(block * trailer.block_size, trailer.block_size);
  };
  parallel_for(trailer.block_count(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::uint64_t block = begin; block < end; ++block) {
      if (is_sound(block_of(block), block, table)) continue;
      std::uint64_t known = first_bad;
      while (block < known && !first_bad.compare_exchange_weak(known, block)) {
      }
    }
  });
  if (first_bad < trailer.block_count()) require_sound_block(block_of(first_bad), first_bad, table, trailer);
}

}  // namespace

TrailerForm form_for(std::uint64_t content_size) {
  return content_size >= block_hashes_from ? TrailerForm::block_hashes : TrailerForm::one_hash;
}

std::uint64_t Trailer::block_count() const {
  return block_size == 0 ? 0 : (content_size() + block_size - 1) / block_size;
}

Trailer parse_trailer(std::string_view last, std::uint64_t file_size) {
  // What is cheap and says most comes first: a file cut short fails by its size or its magic, and only a
  // whole one is hashed.
  require_format(
      file_size >= trailer_size && last.size() == trailer_size,
      "has " + std::to_string(file_size) + " bytes, less than the trailer of an asset: not a bespoke asset");
  require_format(last.substr(0, 8) == magic,
                 "does not end in a bespoke trailer: not a bespoke asset, or cut short");
  Trailer trailer;
  trailer.form = form_of(little_endian(last.substr(8, 4)));
  const std::uint64_t block = little_endian(last.substr(12, 4));
  require_format(
      trailer.form == TrailerForm::one_hash ? block == 0 : block >= min_block && block <= largest_block,
      "trailer is damaged");
  trailer.block_size = block;
  trailer.vdb_size = little_endian(last.substr(16, 8));
  trailer.exact_size = little_endian(last.substr(24, 8));
  trailer.digest = hex(last.substr(digest_offset));
  const std::uint64_t before = file_size - trailer_size;
  require_format(trailer.vdb_size <= before && trailer.exact_size <= before - trailer.vdb_size &&
                     trailer.content_size() + trailer.table_size() == before,
                 "is " + std::to_string(before) + " bytes long before its trailer, which says otherwise");
  return trailer;
}

void require_sound_table(std::string_view table, std::string_view last, const Trailer& trailer) {
  Sha256 hash;
  hash.update(table.data(), table.size());
  hash.update(last.data(), digest_offset);
  require_format(hash.finish() == trailer.digest,
                 "SHA-256 of the blocks' hashes does not match: the file was damaged or changed");
}

void require_sound_block(std::string_view bytes, std::uint64_t block, std::string_view table,
                         const Trailer& trailer) {
  require_format(is_sound(bytes, block, table), "SHA-256 of the block at byte " +
                                                    std::to_string(block * trailer.block_size) +
                                                    " does not match: the file was damaged or changed");
}

std::string seal(const AssetSections& sections, TrailerForm form) {
  std::string bytes;
  const std::size_t content = sections.vdb.size() + sections.exact_map.size();
  bytes.reserve(content + trailer_size +
                (form == TrailerForm::block_hashes ? digest_size * (content / block_size + 1) : 0));
  bytes.append(sections.vdb).append(sections.exact_map);
  if (form == TrailerForm::block_hashes) bytes.append(table_of(bytes));
  bytes.append(magic);
  append_little_endian(bytes, static_cast<std::uint64_t>(form), 4);
  append_little_endian(bytes, form == TrailerForm::block_hashes ? block_size : 0, 4);
  append_little_endian(bytes, sections.vdb.size(), 8);
  append_little_endian(bytes, sections.exact_map.size(), 8);
  const std::size_t hashed_from = form == TrailerForm::block_hashes ? content : 0;
  append_digest(bytes, sha256(bytes.data() + hashed_from, bytes.size() - hashed_from));
  return bytes;
}

AssetSections unseal(std::string_view bytes) {
  const std::string_view last = bytes.substr(bytes.size() - std::min(bytes.size(), trailer_size));
  const Trailer trailer = parse_trailer(last, bytes.size());
  const std::string_view content = bytes.substr(0, trailer.content_size());
  if (trailer.form == TrailerForm::one_hash) {
    require_format(sha256(bytes.data(), bytes.size() - digest_size) == trailer.digest,
                   "SHA-256 does not match: the file was damaged or changed");
  } else {
    const std::string_view table = bytes.substr(content.size(), trailer.table_size());
    require_sound_table(table, last, trailer);
    require_sound_blocks(content, table, trailer);
  }
  return {content.substr(0, trailer.vdb_size), content.substr(trailer.vdb_size)};
}

}  // namespace bespoke
