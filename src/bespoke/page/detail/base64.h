#pragma once

#include <string>

namespace bespoke {

/// RFC 4648, with padding.
std::string base64(const std::string& bytes);

}  // namespace bespoke
