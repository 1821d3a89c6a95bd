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

/// A line of one side.
struct NamedLine {
  std::string name;  ///< may be empty
  Points points;     ///< 3×n, mesh units
  bool closed = false;
};

/// What a file with one side holds.
struct FileSide {
  std::vector<NamedPoint> points;
  std::vector<NamedLine> lines = {};  ///< AnchorFormat::markups alone has a place for them
};

/// One side of a format that has a file per side. `mesh`: for `wrap`. Throws FormatError naming the file and
/// the line or the point.
FileSide parse_side(const std::string& text, AnchorFormat format, const std::string& file,
                    const TriangleMesh* mesh, PatientSystem models);

/// The text of such a file.
std::string side_text(const FileSide& side, AnchorFormat format, const TriangleMesh* mesh,
                      PatientSystem models);

}  // namespace bespoke
