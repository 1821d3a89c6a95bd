#pragma once

#include "bespoke/surface_fit/matching/reciprocity.h"

namespace bespoke {

/// Whether the match is in front of the point's own surface; crease() is 0 where it is not.
bool may_be_creased(const FoundPair& pair);

/// How sharply the surface is creased under a pair with this ratio of back distance to distance
/// (reciprocity.h, searched over the whole distance), 0 to 1: (1 − ratio²)²; cos⁴ α at the bottom of a
/// wedge of angle 2α with the match on the bisector, 0 where the surface is flat or convex and where the
/// match is behind it. An armpit under a raised arm is far from its counterpart because it must unfold, not
/// because the pair is wrong.
double crease(const FoundPair& pair, double back_ratio);

}  // namespace bespoke
