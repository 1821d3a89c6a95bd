#pragma once

#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/topology/mesh_components.h"

namespace bespoke {

/// A component of the source without a counterpart on the target: a helper mesh, a marker of a joint, a
/// garment. The map carries it as it carries a product.
struct LoosePart {
  int component = 0;     ///< in the order of least vertices, from 0
  int first_vertex = 0;  ///< its least vertex
  int vertices = 0;
  int faces = 0;
  std::string name;  ///< of its group in the source's file; empty where that is not known
};

/// Which components of the source are registered to the target.
struct RegisteredParts {
  MeshComponents components;  ///< of the source, those along a seam joined
  std::vector<char> is_kept;  ///< one flag a component

  bool is_whole() const;
  PartialMesh mesh(const TriangleMesh& source) const { return kept_components(source, components, is_kept); }
};

/// All components, unless the source has more of them than the target: then the one with the most anchors
/// that lie on both surfaces (points of curves are anchors; with fewer than three, that of the most faces, if
/// it is about as large as the source), and every other with such an anchor.
RegisteredParts parts_to_register(const TriangleMesh& source, const TriangleMesh& target,
                                  const Anchors& anchors);

/// Where the kept parts, whose vertices lie at `registered` (target frame, in the order of
/// parts.mesh(source)), leave the target uncovered: keeps the other components too that come to lie there.
/// Whether there are any.
bool keep_uncovered(RegisteredParts& parts, const TriangleMesh& source, const TriangleMesh& target,
                    const Points& registered);

std::vector<LoosePart> loose_parts(const RegisteredParts& parts);

/// The parts of the source that no registration moves.
struct LoosePartsSummary {
  int parts = 0;  ///< of the source
  std::vector<LoosePart> loose;
};

/// "153 of 154 parts of the source have no counterpart on the target and follow the map as products do:
/// "joint-l-hand" (8 vertices), …"; the largest first, of one name together, ten at most.
std::string to_string(const LoosePartsSummary& summary);

}  // namespace bespoke
