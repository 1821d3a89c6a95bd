#include "bespoke/asset/detail/trailer.h"

#include <cstdint>

#include "bespoke/error.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

constexpr std::string_view magic("BESPOKE\n", 8);
constexpr std::uint64_t version = 1;
constexpr std::size_t digest_size = 32;

void append_little_endian(std::string& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<char>(value >> (8 * i) & 0xff));
}

std::uint64_t little_endian(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = bytes.size(); i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[i]);
  return value;
}

void append_digest(std::string& bytes) {
  const std::string hex = sha256(bytes.data(), bytes.size());
  for (std::size_t i = 0; i < digest_size; ++i)
    bytes.push_back(static_cast<char>(std::stoi(hex.substr(2 * i, 2), nullptr, 16)));
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

void require(bool holds, const std::string& what) {
  if (!holds) throw FormatError(what);
}

}  // namespace

std::string seal(const AssetSections& sections) {
  std::string bytes;
  bytes.reserve(sections.vdb.size() + sections.exact_map.size() + trailer_size);
  bytes.append(sections.vdb).append(sections.exact_map).append(magic);
  append_little_endian(bytes, version, 4);
  append_little_endian(bytes, 0, 4);
  append_little_endian(bytes, sections.vdb.size(), 8);
  append_little_endian(bytes, sections.exact_map.size(), 8);
  append_digest(bytes);
  return bytes;
}

AssetSections unseal(std::string_view bytes) {
  // What is cheap and says most comes first: a file cut short fails by its size or its magic, and only a
  // whole one is hashed.
  require(bytes.size() >= trailer_size, "has " + std::to_string(bytes.size()) +
                                            " bytes, less than the trailer of an asset: not a bespoke asset");
  const std::string_view content = bytes.substr(0, bytes.size() - trailer_size);
  const std::string_view trailer = bytes.substr(content.size());
  require(trailer.substr(0, 8) == magic,
          "does not end in a bespoke trailer: not a bespoke asset, or cut short");
  const std::uint64_t found_version = little_endian(trailer.substr(8, 4));
  require(found_version == version,
          "trailer version " + std::to_string(found_version) + "; this program reads version 1");
  require(little_endian(trailer.substr(12, 4)) == 0, "trailer is damaged");
  const std::uint64_t vdb_size = little_endian(trailer.substr(16, 8));
  const std::uint64_t exact_size = little_endian(trailer.substr(24, 8));
  require(vdb_size <= content.size() && exact_size == content.size() - vdb_size,
          "is " + std::to_string(content.size()) + " bytes long before its trailer, which says otherwise");
  require(sha256(bytes.data(), bytes.size() - digest_size) == hex(trailer.substr(trailer_size - digest_size)),
          "SHA-256 does not match: the file was damaged or changed");
  return {content.substr(0, vdb_size), content.substr(vdb_size)};
}

}  // namespace bespoke
