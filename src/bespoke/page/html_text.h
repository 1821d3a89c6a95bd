#pragma once

#include <string>

namespace bespoke {

/// Text as it stands between tags, or in a quoted attribute.
std::string escaped(const std::string& text);

/// A relative file, with slashes, as a link's address: what addresses do not hold as it is, as %XX.
std::string link_address(const std::string& file);

}  // namespace bespoke
