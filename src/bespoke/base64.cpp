#include "bespoke/base64.h"

#include <openssl/evp.h>

#include <algorithm>

namespace bespoke {
namespace {

// OpenSSL counts in ints. Multiples of the 3 bytes that become 4 characters.
constexpr std::size_t bytes_per_call = std::size_t{3} << 24, characters_per_call = std::size_t{4} << 24;

const unsigned char* unsigned_data(std::string_view text) {
  return reinterpret_cast<const unsigned char*>(text.data());
}

}  // namespace

std::string base64(std::string_view bytes) {
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // it ends what it writes by a zero
  auto* to = reinterpret_cast<unsigned char*>(text.data());
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), bytes_per_call)))
    to += EVP_EncodeBlock(to, unsigned_data(bytes), static_cast<int>(std::min(bytes.size(), bytes_per_call)));
  text.pop_back();
  return text;
}

std::optional<std::string> bytes_of_base64(std::string_view text) {
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  // OpenSSL takes padding anywhere for zeros.
  if (text.size() % 4 == 1 || text.find('=') != std::string_view::npos) return std::nullopt;
  const std::string padded = std::string(text) + std::string((4 - text.size() % 4) % 4, '=');
  std::string bytes(padded.size() / 4 * 3, '\0');
  auto* to = reinterpret_cast<unsigned char*>(bytes.data());
  for (std::string_view rest = padded; !rest.empty();) {
    const std::string_view part = rest.substr(0, characters_per_call);
    // It skips blanks at the ends of what it reads, and then writes less.
    const int written = EVP_DecodeBlock(to, unsigned_data(part), static_cast<int>(part.size()));
    if (written != static_cast<int>(part.size() / 4 * 3)) return std::nullopt;
    to += written;
    rest.remove_prefix(part.size());
  }
  bytes.resize(text.size() * 3 / 4);
  return bytes;
}

}  // namespace bespoke
