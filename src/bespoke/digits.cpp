#include "bespoke/digits.h"

#include <array>
#include <charconv>

namespace bespoke {

std::string in_digits(double value, int digits) {
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), end.ptr};
}

std::string in_digits(const Vector3& vector, int digits) {
  std::string text = "(";
  for (const double value : vector) text += in_digits(value, digits) + ", ";
  text.resize(text.size() - 1);
  text.back() = ')';
  return text;
}

}  // namespace bespoke
