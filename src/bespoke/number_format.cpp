#include "bespoke/number_format.h"

#include <array>
#include <charconv>

namespace bespoke {

std::string format_number(double value, int digits) {
  std::array<char, 32> text;
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits);
  return {text.data(), end.ptr};
}

std::string format_number(const Vector3& vector, int digits) {
  std::string text = "(";
  for (const double value : vector) text += format_number(value, digits) + ", ";
  text.resize(text.size() - 1);
  text.back() = ')';
  return text;
}

}  // namespace bespoke
