#pragma once

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Whether the surfaces face opposite ways, as when the faces of one of them were written inside out: the
/// normals of two in three vertices of the source point against those of the target's faces nearest to them.
/// source: roughly in place.
bool faces_away(const TriangleMesh& source, const TriangleMesh& target);

/// The mesh with every face flipped.
TriangleMesh flipped(TriangleMesh mesh);

}  // namespace bespoke
