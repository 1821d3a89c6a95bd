#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "bespoke/product/ply/ply_header.h"

namespace bespoke {

/// Numbers in binary PLY files.

static_assert(std::endian::native == std::endian::little);

/// Calls `use` with a zero of the type, so that loops are compiled for every type.
template <class Use>
auto with_type(PlyScalar type, const Use& use) {
  switch (type) {
    case PlyScalar::int8:
      return use(std::int8_t{});
    case PlyScalar::uint8:
      return use(std::uint8_t{});
    case PlyScalar::int16:
      return use(std::int16_t{});
    case PlyScalar::uint16:
      return use(std::uint16_t{});
    case PlyScalar::int32:
      return use(std::int32_t{});
    case PlyScalar::uint32:
      return use(std::uint32_t{});
    case PlyScalar::float32:
      return use(float{});
    case PlyScalar::float64:
      break;
  }
  return use(double{});
}

template <class Value>
Value load_scalar(const char* bytes, bool is_big) {
  std::array<char, sizeof(Value)> raw;
  std::memcpy(raw.data(), bytes, sizeof(Value));
  if (is_big) std::reverse(raw.begin(), raw.end());
  return std::bit_cast<Value>(raw);
}

template <class Value>
void store_scalar(char* bytes, double value, bool is_big) {
  auto raw = std::bit_cast<std::array<char, sizeof(Value)>>(static_cast<Value>(value));
  if (is_big) std::reverse(raw.begin(), raw.end());
  std::memcpy(bytes, raw.data(), sizeof(Value));
}

inline bool is_big(const PlyHeader& header) { return header.encoding == PlyHeader::Encoding::big_endian; }

/// A list's length, which may be negative.
inline long long list_length(const char* bytes, PlyScalar type, bool is_big) {
  return with_type(
      type, [&](auto zero) { return static_cast<long long>(load_scalar<decltype(zero)>(bytes, is_big)); });
}

/// Goes behind a property of a whole record, and returns the number of its values.
inline std::uint64_t skip_property(const PlyProperty& property, const char* bytes, bool is_big,
                                   std::size_t& at) {
  std::uint64_t values = 1;
  if (property.count) {
    values = static_cast<std::uint64_t>(list_length(bytes + at, *property.count, is_big));
    at += size(*property.count);
  }
  at += static_cast<std::size_t>(values) * size(property.type);
  return values;
}

}  // namespace bespoke
