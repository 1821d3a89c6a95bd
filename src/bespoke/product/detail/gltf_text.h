#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace bespoke {

/// The elements of the array under a key of a JSON object's top level.
struct JsonArray {
  std::vector<std::string_view> elements;  ///< their characters
  std::size_t end = 0;                     ///< of the bracket that closes it, in the text
};

/// `text` must be a JSON object without syntax errors that has such an array.
JsonArray find_array(std::string_view text, std::string_view key);

/// The bytes of base64 text; false where it is none.
bool decode_base64(std::string_view text, std::string& bytes);
std::string encode_base64(std::string_view bytes);

/// A relative URI as a file's name: "%20" is a blank.
std::string decoded_uri(std::string_view uri);

}  // namespace bespoke
