#pragma once

#include <string>

#include "bespoke/anchors/detail/point_files.h"

namespace bespoke {

/// 3D Slicer's markups: every list of type Fiducial holds points, every Curve and ClosedCurve a line through
/// its control points (3D Slicer itself draws a spline through them). Control points without a defined
/// position are left out. Throws FormatError "file: markup 1 …" for lists of other types, for curves of fewer
/// than two places, and for what is no such file.
FileSide parse_markups(const std::string& text, const std::string& file, PatientSystem models);

/// One list of points, then one for each line.
std::string markups_text(const FileSide& side, PatientSystem models);

}  // namespace bespoke
