#pragma once

#include <filesystem>
#include <string>

namespace bespoke {

/// The unit that a file's format fixes: "m" for glTF, by the ending of the name; empty for the others, which
/// leave it open.
std::string unit_of_format(const std::filesystem::path& path);

/// Throws InvalidInput, naming the factor between them, where a model's format fixes a unit and `unit`, as an
/// anchors file says it, is another one or unknown. An empty one is no contradiction.
void require_unit_of_format(const std::filesystem::path& model, const std::string& unit);

}  // namespace bespoke
