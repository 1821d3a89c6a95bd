#pragma once

#include <string>
#include <string_view>

namespace bespoke {

/// What an exception of the JSON library says, without its name and number: "key 'unit' not found" of
/// "[json.exception.out_of_range.403] key 'unit' not found".
inline std::string json_reason(std::string_view what) {
  const std::size_t end = what.find("] ");
  return std::string(what.substr(what.starts_with("[json.") && end != what.npos ? end + 2 : 0));
}

}  // namespace bespoke
