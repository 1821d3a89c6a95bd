#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace bespoke {

/// Metres of a unit by one of its names ("mm", "cm", "m", "metres", "in" …), whatever their case; none for
/// other names.
std::optional<double> metres_per_unit(const std::string& unit);

/// The unit that a file's format fixes: "m" for glTF, and what a 3MF file says (or else "mm"), for which its
/// beginning is read; empty for the others, which leave it open. By the ending of the name.
std::string unit_of_format(const std::filesystem::path& path);

/// Throws InvalidInput, naming the factor between them, where a model's format fixes a unit and `unit`, as an
/// anchors file says it, is another one or unknown. An empty one is no contradiction.
void require_unit_of_format(const std::filesystem::path& model, const std::string& unit);

}  // namespace bespoke
