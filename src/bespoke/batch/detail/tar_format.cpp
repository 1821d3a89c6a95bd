#include "bespoke/batch/detail/tar_format.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string_view>

namespace bespoke {
namespace {

constexpr std::uint64_t block_bytes = 512;

// Of an archive of small products one reading takes several members, of one of large ones the headers alone.
constexpr std::uint64_t window_bytes = 8192;

// A pax header is read as a whole; a record of a hundred thousand outputs takes 20 MB.
constexpr std::uint64_t max_pax_bytes = std::uint64_t{1} << 30;

constexpr std::uint64_t max_octal_bytes = (std::uint64_t{1} << 33) - 1;  // eleven digits

// Flags of what a member is.
constexpr char regular = '0', pax_of_next = 'x', pax_of_all = 'g', gnu_long_name = 'L';

// A field of the header: where it begins, and its bytes.
struct Field {
  std::size_t begin, bytes;
};
constexpr Field name_field{0, 100}, mode_field{100, 8}, owner_field{108, 8}, group_field{116, 8},
    size_field{124, 12}, time_field{136, 12}, sum_field{148, 8}, prefix_field{345, 155};
constexpr std::size_t kind_place = 156, magic_place = 257;
constexpr std::string_view magic("ustar\00000", 8);

using Block = std::array<char, block_bytes>;

/// Octal digits and a zero byte.
void put_number(Block& block, Field field, std::uint64_t value) {
  for (std::size_t i = field.bytes - 1; i-- > 0; value >>= 3)
    block[field.begin + i] = static_cast<char>('0' + (value & 7));
}

std::optional<std::uint64_t> number(const char* block, Field field) {
  const char* begin = block + field.begin;
  const char* end = begin + field.bytes;
  begin = std::find_if(begin, end, [](char c) { return c != ' '; });
  std::uint64_t value = 0;
  const auto [stop, error] = std::from_chars(begin, end, value, 8);
  const bool is_closed = stop == end || *stop == '\0' || *stop == ' ';
  return error == std::errc() && is_closed ? std::optional(value) : std::nullopt;
}

std::string text(const char* block, Field field) {
  const char* begin = block + field.begin;
  return {begin, std::find(begin, begin + field.bytes, '\0')};
}

/// Of all bytes, those of the sum itself as blanks.
std::uint64_t sum_of(const char* block) {
  std::uint64_t sum = 0;
  for (std::size_t i = 0; i < block_bytes; ++i) {
    const bool is_own = i >= sum_field.begin && i < sum_field.begin + sum_field.bytes;
    sum += is_own ? ' ' : static_cast<unsigned char>(block[i]);
  }
  return sum;
}

std::string header_block(const std::string& name, std::uint64_t bytes, std::int64_t modified, char kind) {
  Block block{};
  std::memcpy(&block[name_field.begin], name.data(), std::min(name.size(), name_field.bytes));
  put_number(block, mode_field, 0644);
  put_number(block, owner_field, 0);
  put_number(block, group_field, 0);
  put_number(block, size_field, std::min(bytes, max_octal_bytes));
  put_number(block, time_field, static_cast<std::uint64_t>(std::max<std::int64_t>(modified, 0)));
  block[kind_place] = kind;
  std::memcpy(&block[magic_place], magic.data(), magic.size());
  put_number(block, {sum_field.begin, sum_field.bytes - 1}, sum_of(block.data()));
  block[sum_field.begin + sum_field.bytes - 1] = ' ';
  return {block.data(), block.size()};
}

/// "LENGTH KEY=VALUE\n", the length being that of all of it.
std::string pax_record(const std::string& key, const std::string& value) {
  const std::size_t rest = key.size() + value.size() + 3;
  std::size_t bytes = rest;
  while (bytes != rest + std::to_string(bytes).size()) bytes = rest + std::to_string(bytes).size();
  return std::to_string(bytes) + " " + key + "=" + value + "\n";
}

std::string pax_value(std::string_view records, std::string_view key) {
  std::string value;
  while (!records.empty()) {
    std::size_t bytes = 0;
    const auto [stop, error] = std::from_chars(records.data(), records.data() + records.size(), bytes);
    const std::size_t digits = static_cast<std::size_t>(stop - records.data());
    if (error != std::errc() || bytes > records.size() || bytes < digits + 2) break;
    const std::string_view record = records.substr(digits + 1, bytes - digits - 2);
    if (record.size() > key.size() && record.starts_with(key) && record[key.size()] == '=')
      value = record.substr(key.size() + 1);
    records.remove_prefix(bytes);
  }
  return value;
}

std::string whole_pax(const std::string& records, char kind) {
  return header_block(kind == pax_of_all ? "pax_global_header" : "pax_header", records.size(), 0, kind) +
         records + tar_padding(records.size());
}

std::uint64_t padded(std::uint64_t bytes) { return (bytes + block_bytes - 1) / block_bytes * block_bytes; }

}  // namespace

std::string tar_header(const std::string& name, std::uint64_t bytes, std::int64_t modified) {
  std::string records;
  if (name.size() > name_field.bytes) records += pax_record("path", name);
  if (bytes > max_octal_bytes) records += pax_record("size", std::to_string(bytes));
  return (records.empty() ? "" : whole_pax(records, pax_of_next)) +
         header_block(name, bytes, modified, regular);
}

std::string tar_padding(std::uint64_t bytes) { return std::string(padded(bytes) - bytes, '\0'); }

std::string tar_comment(const std::string& text) {
  return whole_pax(pax_record("comment", text), pax_of_all);
}

std::string tar_end() { return std::string(2 * block_bytes, '\0'); }

struct TarReader::Header {
  char kind;
  std::string name;
  std::uint64_t bytes;
};

std::string TarReader::read(std::uint64_t offset, std::uint64_t bytes) {
  if (offset < window_begin_ || offset + bytes > window_begin_ + window_.size()) {
    window_ = file_.read(offset, std::min(std::max(bytes, window_bytes), bytes_ - offset));
    window_begin_ = offset;
  }
  return window_.substr(offset - window_begin_, bytes);
}

std::optional<TarReader::Header> TarReader::read_header(std::uint64_t offset) {
  if (offset + block_bytes > bytes_) return std::nullopt;
  const std::string block = read(offset, block_bytes);
  const auto size = number(block.data(), size_field), sum = number(block.data(), sum_field);
  if (!size || !sum || *sum != sum_of(block.data())) {
    const std::string end = tar_end();
    ended_ = offset + end.size() == bytes_ && read(offset, end.size()) == end;
    return std::nullopt;
  }
  std::string name = text(block.data(), name_field);
  if (const std::string prefix = text(block.data(), prefix_field);
      !prefix.empty() && std::string_view(block).substr(magic_place).starts_with(magic))
    name = prefix + "/" + name;
  return Header{block[kind_place], std::move(name), *size};
}

std::optional<TarMember> TarReader::next() {
  TarMember member;
  member.begin = offset_;
  std::string name, size;
  for (std::uint64_t offset = offset_;;) {
    const std::optional<Header> header = read_header(offset);
    if (!header) return std::nullopt;
    member.content = offset + block_bytes;
    member.name = name.empty() ? header->name : name;
    member.bytes = header->bytes;
    if (!size.empty()) std::from_chars(size.data(), size.data() + size.size(), member.bytes);
    if (member.bytes > bytes_ || member.content + padded(member.bytes) > bytes_) return std::nullopt;
    member.end = member.content + padded(member.bytes);
    const bool is_of_next = header->kind == pax_of_next || header->kind == gnu_long_name;
    const bool is_text = is_of_next || header->kind == pax_of_all;
    if (is_text && member.bytes > max_pax_bytes) return std::nullopt;
    const std::string content = is_text ? read(member.content, member.bytes) : std::string();
    if (header->kind == pax_of_next) {
      if (const std::string path = pax_value(content, "path"); !path.empty()) name = path;
      size = pax_value(content, "size");
    } else if (header->kind == gnu_long_name) {
      name = content.c_str();
    } else if (header->kind == pax_of_all) {
      member.kind = TarMember::Kind::comment;
      member.comment = pax_value(content, "comment");
    } else if (header->kind == regular || header->kind == '\0') {
      member.kind = TarMember::Kind::file;
    }
    if (!is_of_next) break;
    offset = member.end;
  }
  offset_ = member.end;
  return member;
}

}  // namespace bespoke
