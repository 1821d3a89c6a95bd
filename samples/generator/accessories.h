#pragma once

#include "bespoke/mesh/triangle_mesh.h"
#include "foot.h"
#include "hand.h"
#include "head.h"

namespace bespoke {

/// Products that stay clear of the reference model `head`, `hand` or `foot` of the given build.

/// Rims, bridge and temples in one closed piece.
TriangleMesh glasses_frame(const HeadBuild& build, const Anatomy& head);

/// Two open, slightly domed discs that fill the frame's rims.
TriangleMesh glasses_lenses(const HeadBuild& build);

/// Open at the wrist.
TriangleMesh glove(const HandBuild& build, const Anatomy& hand);

/// A court shoe: the upper, open at the top, and the closed sole with its heel.
TriangleMesh shoe_upper(const FootBuild& build, const Anatomy& foot);
TriangleMesh shoe_sole(const FootBuild& build, const Anatomy& foot);

}  // namespace bespoke
