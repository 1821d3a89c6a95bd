#include "bespoke/registration/fit_patches.h"

#include <algorithm>
#include <optional>
#include <string>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"

namespace bespoke {
namespace {

/// Says in which patch points of a model lie, where no border is near.
class PatchFinder {
 public:
  PatchFinder(const TriangleMesh& mesh, const FacePatches& patches)
      : mesh_(mesh), tree_(mesh), of_vertex_(vertex_patches(mesh, patches)) {
    near_.max_distance = on_surface * diagonal(mesh.vertices);
  }

  std::optional<int> operator()(const Vector3& x) const {
    const std::optional<SurfacePoint> foot = tree_.closest(x, near_);
    if (!foot) return std::nullopt;
    const int face = foot->face;
    const auto at = [&](int corner) {
      return of_vertex_[static_cast<std::size_t>(mesh_.faces(corner, face))];
    };
    return at(0) == at(1) && at(1) == at(2) ? at(0) : std::nullopt;
  }

 private:
  static constexpr double on_surface = 0.02;  // of the diagonal: farther ones are points of space

  const TriangleMesh& mesh_;
  ClosestPointTree tree_;
  ClosestPointQuery near_;
  std::vector<std::optional<int>> of_vertex_;
};

void require_sides_agree(const Anchors& anchors, const FitPatches& patches, const TriangleMesh& source,
                         const TriangleMesh& target) {
  const PatchFinder on_source(source, patches.source), on_target(target, patches.target);
  std::vector<int> together(anchors.patches.size(), 0), apart = together;
  for (const AnchorPair& pair : anchors.pairs) {
    const std::optional<int> a = on_source(pair.a), b = on_target(pair.b);
    if (!a || !b) continue;
    if (*a == *b && *a >= 0) ++together[static_cast<std::size_t>(*a)];
    for (const int patch : {*a, *b})
      if (*a != *b && patch >= 0) ++apart[static_cast<std::size_t>(patch)];
  }
  for (std::size_t k = 0; k < anchors.patches.size(); ++k)
    if (apart[k] > together[k])
      throw InvalidInput(label(anchors.patches, k, ModelSide::source) + ": " + std::to_string(apart[k]) +
                         " pairs lie inside it on one model and outside on the other, " +
                         std::to_string(together[k]) +
                         " inside on both; a border's inside is the side with less area: where the other one "
                         "is meant, give its faces");
}

}  // namespace

FitPatches fit_patches(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target) {
  FitPatches patches;
  if (anchors.patches.empty()) return patches;
  if (anchors.pairs.empty() && anchors.curves.empty())
    throw InvalidInput("patches pair parts but fix no positions; give at least 4 anchor pairs as well");
  patches.source = face_patches(source, anchors.patches, ModelSide::source);
  patches.target = face_patches(target, anchors.patches, ModelSide::target);
  require_sides_agree(anchors, patches, source, target);
  patches.borders = patch_borders(anchors, source, target);
  for (std::size_t k = 0; k < anchors.patches.size(); ++k)
    patches.found.push_back({anchors.patches[k].name, anchors.patches[k].exclude, patches.source.sizes[k],
                             patches.target.sizes[k], std::nullopt});
  return patches;
}

}  // namespace bespoke
