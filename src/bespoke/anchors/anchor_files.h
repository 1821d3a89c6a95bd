#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/enum_names.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// The kinds of files that other programs keep pairs of points in.
enum class AnchorFormat {
  json,       ///< this project's, both sides in one file
  csv,        ///< this project's, both sides in one file
  meshlab,    ///< MeshLab's PickedPoints (.pp), one file a side
  markups,    ///< 3D Slicer's markups (.mrk.json), one file a side, of one or several lists
  fiducials,  ///< 3D Slicer's older fiducials (.fcsv), one file a side
  landmarks,  ///< Landmark Editor's points (.pts), one file a side
  wrap,  ///< [triangle, u, v] lists (.json of arrays), one file a side: (1 − u − v) p₀ + u p₁ + v p₂
  indices,  ///< two vertex numbers a line, counted from 0 (.txt), both sides in one file
};

inline constexpr std::array anchor_formats{Named<AnchorFormat>{"json", AnchorFormat::json},
                                           Named<AnchorFormat>{"csv", AnchorFormat::csv},
                                           Named<AnchorFormat>{"meshlab", AnchorFormat::meshlab},
                                           Named<AnchorFormat>{"markups", AnchorFormat::markups},
                                           Named<AnchorFormat>{"fiducials", AnchorFormat::fiducials},
                                           Named<AnchorFormat>{"landmarks", AnchorFormat::landmarks},
                                           Named<AnchorFormat>{"wrap", AnchorFormat::wrap},
                                           Named<AnchorFormat>{"indices", AnchorFormat::indices}};

/// Patient coordinates of 3D Slicer: x to the left and y to the back, or x to the right and y to the front.
enum class PatientSystem { lps, ras };

/// By the ending of a file's name, and for .json by what stands in it where it is there already. Throws
/// UnknownEnding.
AnchorFormat anchor_format_of(const std::filesystem::path& path);

/// Whether each side has a file of its own.
bool has_file_per_side(AnchorFormat format);

struct AnchorFileOptions {
  const TriangleMesh* source = nullptr;  ///< needed for `wrap` and `indices`
  const TriangleMesh* target = nullptr;
  PatientSystem models =
      PatientSystem::lps;  ///< what the models' coordinates are; 3D Slicer writes models so
};

/// Whether the format has a place for curves. 3D Slicer's markups keep a line as the control points of a
/// Curve or a ClosedCurve, without fixed points; 3D Slicer draws a spline through them, here straight lines
/// join them.
bool has_curves(AnchorFormat format);

/// Reads what one file holds, or two with a side each: points of one name are a pair where all names are
/// given and the same on both sides, else the first with the first and so on; curves likewise. Throws
/// FileError, FormatError naming file and place, InvalidInput where a model or a file is missing.
Anchors read_anchor_files(const std::vector<std::filesystem::path>& paths,
                          const AnchorFileOptions& options = {});

/// The same of one file that has both sides. A file of one side is refused with the `anchors convert` line
/// that joins it with the other one, where that lies beside it: InvalidInput. A name without an ending is
/// read as JSON.
Anchors read_anchor_file(const std::filesystem::path& path, const AnchorFileOptions& options = {});

/// The text of a file of AnchorFormat::json.
std::string anchors_json(const Anchors& anchors);

/// What of the anchors a format has no place for, as a list: "the unit (cm), the names of 9 pairs, 2 curves";
/// empty for nothing.
std::string left_out(const Anchors& anchors, AnchorFormat format);

/// Writes one file, or two with a side each, as read_anchor_files reads it; each atomically. What the format
/// has no place for is left out (left_out). `wrap` and `indices` write the place of the mesh
/// that is nearest to a point. Throws as reading does.
void write_anchor_files(const std::vector<std::filesystem::path>& paths, const Anchors& anchors,
                        const AnchorFileOptions& options = {});

}  // namespace bespoke
