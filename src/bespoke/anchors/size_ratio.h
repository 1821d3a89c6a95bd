#pragma once

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// How many times as large the target is as the source: by three pairs or more, since these know the same
/// parts of both, else by their bounding boxes. 0, infinite or not a number where one of them has no extent.
double size_ratio(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target);

/// Whether models of such a ratio are in two units: beyond a factor of eight, or an eighth. Files of meshes
/// name none; a doll is a sixth of a person, a centimetre a tenth of a decimetre. Not so for a ratio that is
/// not finite and above 0.
bool tells_two_units(double size_ratio);

/// What size_ratio goes by, for a sentence: "their anchors" or "their bounding boxes".
const char* measured_by(const Anchors& anchors);

}  // namespace bespoke
