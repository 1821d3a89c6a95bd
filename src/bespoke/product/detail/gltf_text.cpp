#include "bespoke/product/detail/gltf_text.h"

#include <cassert>
#include <charconv>
#include <cstdint>

namespace bespoke {
namespace {

constexpr std::string_view base64_digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

std::size_t skip_blanks(std::string_view text, std::size_t at) {
  while (at < text.size() && is_blank(text[at])) ++at;
  return at;
}

/// Behind the string that begins at `at`.
std::size_t skip_string(std::string_view text, std::size_t at) {
  for (++at; at < text.size() && text[at] != '"'; ++at)
    if (text[at] == '\\') ++at;
  return at + 1;
}

/// Behind the value that begins at `at`.
std::size_t skip_value(std::string_view text, std::size_t at) {
  int depth = 0;
  while (at < text.size()) {
    const char c = text[at];
    if (c == '"') {
      at = skip_string(text, at);
    } else if (depth == 0 && (c == ',' || c == '}' || c == ']' || is_blank(c))) {
      return at;
    } else {
      depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
      ++at;
    }
    if (depth == 0 && (c == '"' || c == '}' || c == ']')) return at;
  }
  return at;
}

}  // namespace

JsonArray find_array(std::string_view text, std::string_view key) {
  JsonArray array;
  std::size_t at = text.find('{') + 1;
  while (text[at = skip_blanks(text, at)] == '"') {
    const std::size_t name_end = skip_string(text, at);
    const std::string_view name = text.substr(at + 1, name_end - at - 2);
    at = skip_blanks(text, skip_blanks(text, name_end) + 1);  // behind the colon
    const std::size_t end = skip_value(text, at);
    if (name == key) {
      array.elements.clear();
      array.end = end - 1;
      for (at = skip_blanks(text, at + 1); at < array.end; at = skip_blanks(text, at)) {
        const std::size_t element_end = skip_value(text, at);
        array.elements.push_back(text.substr(at, element_end - at));
        at = skip_blanks(text, element_end);
        if (text[at] == ',') ++at;
      }
    }
    at = skip_blanks(text, end);
    if (at < text.size() && text[at] == ',') ++at;
  }
  assert(array.end > 0);
  return array;
}

bool decode_base64(std::string_view text, std::string& bytes) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  bytes.clear();
  bytes.reserve(text.size() * 3 / 4);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : text) {
    const std::size_t digit = base64_digits.find(c);
    if (digit == std::string_view::npos) return false;
    bits = bits << 6 | static_cast<std::uint32_t>(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes += static_cast<char>(bits >> count & 0xff);
  }
  return true;
}

std::string encode_base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k <= bytes.size() ? base64_digits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string decoded_uri(std::string_view uri) {
  std::string name;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const bool is_escape =
        uri[i] == '%' && i + 2 < uri.size() &&
        std::from_chars(uri.data() + i + 1, uri.data() + i + 3, value, 16).ptr == uri.data() + i + 3;
    name += is_escape ? static_cast<char>(value) : uri[i];
    if (is_escape) i += 2;
  }
  return name;
}

}  // namespace bespoke
