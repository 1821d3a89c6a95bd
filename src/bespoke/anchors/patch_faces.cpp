#include "bespoke/anchors/patch_faces.h"

#include <algorithm>
#include <utility>

#include "bespoke/anchors/detail/enclosed_faces.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

EnclosedFaces faces_of(const TriangleMesh& mesh, const PatchSide& part, const std::string& where) {
  if (part.faces.empty()) return enclosed_faces(mesh, part.border, where);
  for (const int face : part.faces)
    if (face < 0 || face >= mesh.faces.cols())
      throw InvalidInput(where + ": there is no face " + std::to_string(face) + "; the model has " +
                         std::to_string(mesh.faces.cols()) +
                         " triangles, numbered from 0. Are the numbers those of another file?");
  return {part.faces, {}};
}

}  // namespace

const PatchSide& part_on(const AnchorPatch& patch, ModelSide side) {
  return side == ModelSide::source ? patch.a : patch.b;
}

std::string label(const std::vector<AnchorPatch>& patches, std::size_t index, ModelSide side) {
  const std::string& name = patches[index].name;
  return "patch " + (name.empty() ? std::to_string(index) : '"' + name + '"') +
         (side == ModelSide::source ? " on the source" : " on the target");
}

bool FacePatches::has_excluded() const {
  return std::find(of_face.begin(), of_face.end(), excluded) != of_face.end();
}

FacePatches face_patches(const TriangleMesh& mesh, const std::vector<AnchorPatch>& patches, ModelSide side) {
  FacePatches result;
  if (patches.empty()) return result;
  const auto count = static_cast<std::size_t>(mesh.faces.cols());
  result.of_face.assign(count, FacePatches::none);
  result.sizes.assign(patches.size(), 0);
  std::vector<char> on_border(count, 0), excluded(count, 0);
  for (std::size_t k = 0; k < patches.size(); ++k) {
    const PatchSide& part = part_on(patches[k], side);
    if (part.is_empty()) continue;
    const EnclosedFaces faces = faces_of(mesh, part, label(patches, k, side));
    for (const int face : faces.crossed) on_border[static_cast<std::size_t>(face)] = 1;
    for (const int number : faces.inside) {
      const auto face = static_cast<std::size_t>(number);
      int& owner = result.of_face[face];
      if (patches[k].exclude)
        result.sizes[k] += std::exchange(excluded[face], 1) ? 0 : 1;
      else if (owner == FacePatches::none)
        owner = static_cast<int>(k);
      else if (owner != static_cast<int>(k) && !on_border[face])
        throw InvalidInput(label(patches, k, side) + ": its face " + std::to_string(number) + " is one of " +
                           label(patches, static_cast<std::size_t>(owner), side) +
                           " too; a face can be in one patch only, so take it out of one of them");
    }
  }
  for (std::size_t face = 0; face < count; ++face)
    if (excluded[face])
      result.of_face[face] = FacePatches::excluded;
    else if (result.of_face[face] != FacePatches::none)
      ++result.sizes[static_cast<std::size_t>(result.of_face[face])];
  if (std::count(excluded.begin(), excluded.end(), 1) == static_cast<std::ptrdiff_t>(count))
    throw InvalidInput(std::string("the patches that are excluded cover the whole ") +
                       (side == ModelSide::source ? "source" : "target") + "; nothing is left to be fitted");
  return result;
}

std::vector<std::optional<int>> vertex_patches(const TriangleMesh& mesh, const FacePatches& patches) {
  std::vector<std::optional<int>> result;
  if (patches.is_empty()) return result;
  result.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  std::vector<char> is_between(result.size(), 0);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (const int vertex : mesh.faces.col(face)) {
      const int own = patches.of_face[static_cast<std::size_t>(face)];
      std::optional<int>& patch = result[static_cast<std::size_t>(vertex)];
      if (patch.value_or(own) != own) is_between[static_cast<std::size_t>(vertex)] = 1;
      patch = own;
    }
  for (std::size_t i = 0; i < result.size(); ++i)
    if (is_between[i]) result[i].reset();
  return result;
}

PatchedMesh without_excluded(const TriangleMesh& mesh, const FacePatches& patches) {
  if (!patches.has_excluded()) return {mesh, patches};
  std::vector<Eigen::Index> kept;
  PatchedMesh result;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const int patch = patches.of_face[static_cast<std::size_t>(face)];
    if (patch == FacePatches::excluded) continue;
    kept.push_back(face);
    result.patches.of_face.push_back(patch);
  }
  result.mesh = {mesh.vertices, mesh.faces(Eigen::all, kept)};
  return result;
}

}  // namespace bespoke
