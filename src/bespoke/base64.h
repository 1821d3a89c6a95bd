#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace bespoke {

/// RFC 4648, with padding (OpenSSL).
std::string base64(std::string_view bytes);

/// The inverse, also of a text without its padding; empty for what is no base64.
std::optional<std::string> bytes_of_base64(std::string_view text);

}  // namespace bespoke
