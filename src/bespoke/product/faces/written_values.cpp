#include "bespoke/product/faces/written_values.h"

#include <array>
#include <charconv>

namespace bespoke {

void append_number(std::string& text, double value, bool as_double) {
  std::array<char, 32> digits;
  const auto end =
      as_double ? std::to_chars(digits.data(), digits.data() + digits.size(), value)
                : std::to_chars(digits.data(), digits.data() + digits.size(), static_cast<float>(value));
  text.append(digits.data(), end.ptr);
}

void append_vector(std::string& bytes, const Vector3& vector, bool as_doubles) {
  for (const double value : vector)
    if (as_doubles)
      append_bytes(bytes, value);
    else
      append_bytes(bytes, static_cast<float>(value));
}

std::size_t polygon_count(const Product& product) {
  return product.polygon_start.empty() ? 0 : product.polygon_start.size() - 1;
}

}  // namespace bespoke
