#pragma once

#include <bit>
#include <cstddef>
#include <string>

#include "bespoke/product/product_io.h"

namespace bespoke {

/// The shortest text that is read back as the same double, or float.
void append_number(std::string& text, double value, bool as_double);

/// Each behind a blank.
void append_words(std::string& text, const auto& values, bool as_doubles) {
  for (const double value : values) {
    text += ' ';
    append_number(text, value, as_doubles);
  }
}

/// Little-endian.
template <class Value>
void append_bytes(std::string& bytes, Value value) {
  static_assert(std::endian::native == std::endian::little);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
void append_vector(std::string& bytes, const Vector3& vector, bool as_doubles);

std::size_t polygon_count(const Product& product);

}  // namespace bespoke
