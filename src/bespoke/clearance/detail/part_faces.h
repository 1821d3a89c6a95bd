#pragma once

#include "bespoke/clearance/detail/face_passages.h"

namespace bespoke {

/// Parts faces that pass through each other, or through a layer, only since the product was carried and
/// corrected: by moves in common, and where these do not help by rounds of pushes, as long as fewer do then
/// and no more samples breach the rule. Returns the pairs that are left.
FacePairs part_faces(FacePassages& passages, double margin, Correction& correction,
                     CorrectionSamples& samples);

}  // namespace bespoke
