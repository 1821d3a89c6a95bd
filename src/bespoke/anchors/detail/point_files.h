#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/anchors/anchor_files.h"

namespace bespoke {

/// A point of one side.
struct NamedPoint {
  std::string name;  ///< may be empty
  Vector3 x;         ///< mesh units
};

/// One side of a format that has a file per side. `mesh`: for `wrap`. Throws FormatError naming the file and
/// the line or the point.
std::vector<NamedPoint> parse_points(const std::string& text, AnchorFormat format, const std::string& file,
                                     const TriangleMesh* mesh, PatientSystem models);

/// The text of such a file.
std::string points_text(const std::vector<NamedPoint>& points, AnchorFormat format, const TriangleMesh* mesh,
                        PatientSystem models);

}  // namespace bespoke
