#pragma once

#include <cstddef>
#include <filesystem>

namespace bespoke {

/// How many primitives of lines a glTF file has: they are carried point by point, but their edges are not
/// split. 0 of other files. Throws as carry_product.
std::size_t unsplit_line_primitives(const std::filesystem::path& path);

}  // namespace bespoke
