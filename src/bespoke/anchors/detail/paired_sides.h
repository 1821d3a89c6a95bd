#pragma once

#include <filesystem>
#include <vector>

#include "bespoke/anchors/detail/point_files.h"

namespace bespoke {

/// The pairs and curves of two files with a side each: points, and lines likewise, of one name belong
/// together where all names are given and the same on both sides, else the first and the first and so on.
/// Throws FormatError naming both files where there are more on one side, or a line is closed on one alone.
Anchors paired(const FileSide& a, const FileSide& b, const std::vector<std::filesystem::path>& paths);

}  // namespace bespoke
