#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bespoke {

/// The text with ASCII capitals turned into small letters.
std::string lower_case(std::string_view text);

/// ".obj" of "Dress.OBJ"; empty for a name without ending.
std::string lower_ending(const std::filesystem::path& path);

/// "a", "a or b", "a, b or c".
std::string alternatives(const std::vector<std::string>& names);

}  // namespace bespoke
