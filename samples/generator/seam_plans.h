#pragma once

#include "accessories.h"
#include "garments.h"
#include "seam_lines.h"

namespace bespoke {

/// Where tailors, glovers and shoemakers would cut the products (garments.h, accessories.h).

/// Front and back, each in a middle and two sides by seams over the bust and the shoulder blades, cut at the
/// waist.
SeamPlan dress_seams(const MannequinBuild& build);

/// The same without a waist seam, with sleeves in two parts.
SeamPlan top_seams(const MannequinBuild& build);

/// Six gores.
SeamPlan skirt_seams(const MannequinBuild& build);

/// A palm and a back, whose edges run along the sides of hand and fingers; the cuff by itself.
SeamPlan glove_seams(const Anatomy& hand);

/// Toe cap, vamp, two quarters and the insole.
SeamPlan upper_seams(const FootBuild& build);

}  // namespace bespoke
