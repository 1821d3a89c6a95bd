#pragma once

#include <cstddef>
#include <string>

#include "bespoke/anchors/patch_faces.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// The parts of two models that are connected by no edge: which of the source's goes onto which of the
/// target's.
struct MatchedParts {
  std::size_t source_parts = 0, target_parts = 0;
  FacePatches source, target;  ///< a patch a part, numbered alike; empty where the parts do not correspond

  bool correspond() const { return !source.is_empty(); }
};

/// Parts of a mesh that no edge connects; vertices in no face are none.
std::size_t part_count(const TriangleMesh& mesh);

/// Parts correspond where both models have as many, two at least, and each is the other's best by place, size
/// and shape: the distance of their centres beside their widths, and the logarithms of the ratios of their
/// widths along principal directions. placed: the source's vertices on the target, 3×n.
MatchedParts match_parts(const TriangleMesh& source, const Points& placed, const TriangleMesh& target);

/// One line.
std::string to_string(const MatchedParts& parts);

}  // namespace bespoke
