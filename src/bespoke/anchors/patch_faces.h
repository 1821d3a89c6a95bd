#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

enum class ModelSide { source, target };

/// The part of a patch that lies on one of the models.
const PatchSide& part_on(const AnchorPatch& patch, ModelSide side);

/// How messages call it, for instance `patch "hair" on the source`, or `patch 2 on the source` for the third.
std::string label(const std::vector<AnchorPatch>& patches, std::size_t index, ModelSide side);

/// Which patch every face of a model is in.
struct FacePatches {
  static constexpr int none = -1;      ///< outside all of them
  static constexpr int excluded = -2;  ///< in one that attracts nothing

  std::vector<int> of_face;  ///< m: the number of the patch, `none` or `excluded`; empty: there are none
  std::vector<std::size_t> sizes;  ///< how many faces each patch has

  bool is_empty() const { return of_face.empty(); }
  bool has_excluded() const;
};

/// Of one model. A patch that has no faces on it counts only on the other. What is excluded is in no other
/// patch. Throws InvalidInput naming the patch: a face that the model does not have, a border that encloses
/// nothing (the smaller side of it is its inside), two patches with a common face (but where a border runs
/// through it; then it belongs to the first), all faces excluded.
FacePatches face_patches(const TriangleMesh& mesh, const std::vector<AnchorPatch>& patches, ModelSide side);

/// n: the patch that all faces at a vertex are in; empty for a vertex between two of them, and for one in no
/// face. No entries where there are no patches.
std::vector<std::optional<int>> vertex_patches(const TriangleMesh& mesh, const FacePatches& patches);

/// The faces that are not excluded, with all vertices.
struct PatchedMesh {
  TriangleMesh mesh;
  FacePatches patches;
};

PatchedMesh without_excluded(const TriangleMesh& mesh, const FacePatches& patches);

}  // namespace bespoke
