#pragma once

#include <string>
#include <vector>

#include "bespoke/anchors/detail/point_files.h"

namespace bespoke {

/// MeshLab's picked points (`.pp`, XML) that are switched on. Throws FormatError naming the file and the line
/// or the point.
std::vector<NamedPoint> parse_meshlab(const std::string& text, const std::string& file);

/// The text of such a file.
std::string meshlab_text(const std::vector<NamedPoint>& points);

}  // namespace bespoke
