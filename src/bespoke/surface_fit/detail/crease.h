#pragma once

#include "bespoke/surface_fit/detail/reciprocity.h"

namespace bespoke {

/// Whether the match is in front of the asking surface; crease() is 0 where it is not.
bool may_be_creased(const FoundPair& pair);

/// How sharply the queried surface is creased under a pair with this claimed share (reciprocity.h, sought
/// over the whole distance of the point), 0 to 1: (1 − claimed²)². At the bottom of a wedge of angle 2α, with
/// the match on the bisector, cos⁴ α. 0 where the surface is flat or bulges, and where the match is behind
/// it. An armpit under a raised arm, or the crook of a finger that curls on the target, is far from its
/// counterpart because a surface must unfold there, not because the pair is wrong.
double crease(const FoundPair& pair, double claimed);

}  // namespace bespoke
