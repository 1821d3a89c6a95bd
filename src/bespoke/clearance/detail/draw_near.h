#pragma once

#include "bespoke/clearance/detail/part_faces.h"

namespace bespoke {

/// Draws places nearer that miss soft obstacles, in passes. Where more samples would miss, or other faces
/// pass through each other than the pairs `left` that are found so far, draws are shortened. A pass whose
/// shortening does not end is taken back. Returns the pairs that are left.
FacePairs draw_near(FacePassages& passages, FacePairs left, Correction& correction,
                    CorrectionSamples& samples);

}  // namespace bespoke
