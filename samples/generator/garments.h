#pragma once

#include "bespoke/mesh/triangle_mesh.h"
#include "mannequin.h"

namespace bespoke {

/// Open surfaces around a mannequin, everywhere outside of it. `body` is the mannequin of `build`.

/// Sleeveless, scoop neck, fitted to the waist, with a flared skirt in soft folds.
TriangleMesh dress(const MannequinBuild& build, const Anatomy& body);

/// Short-sleeved, to just below the waist; hangs outside the skirt.
TriangleMesh top(const MannequinBuild& build, const Anatomy& body);

/// From the waist to above the knee.
TriangleMesh skirt(const MannequinBuild& build, const Anatomy& body);

}  // namespace bespoke
