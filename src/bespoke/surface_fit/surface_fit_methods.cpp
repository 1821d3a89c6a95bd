#include "bespoke/surface_fit/surface_fit_methods.h"

#include <optional>

#include "bespoke/error.h"
#include "bespoke/mesh/facing_outward.h"
#include "bespoke/mesh/require_surface.h"
#include "bespoke/surface_fit/matching/facing.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {
namespace {

void require_consistent_patches(const SurfaceFitInput& input, const SurfaceFitOptions& options) {
  const FacePatches &source = input.source_patches, &target = input.target_patches;
  if (source.is_empty() && target.is_empty()) return;
  if (options.method != SurfaceFitMethod::deformation_graph)
    throw InvalidInput("patches are known to the surface fitting \"" +
                       std::string(entry_of(SurfaceFitMethod::deformation_graph).name) +
                       "\" alone, not to \"" + std::string(entry_of(options.method).name) +
                       "\"; leave the patches out, or take the other");
  if (static_cast<Eigen::Index>(source.of_face.size()) != input.source.faces.cols() ||
      static_cast<Eigen::Index>(target.of_face.size()) != input.target.faces.cols())
    throw InvalidInput("surface fitting: patches of " + std::to_string(source.of_face.size()) +
                       " source faces and " + std::to_string(target.of_face.size()) +
                       " target faces, but there are " + std::to_string(input.source.faces.cols()) + " and " +
                       std::to_string(input.target.faces.cols()));
}

void require_consistent(const SurfaceFitInput& input, const SurfaceFitOptions& options) {
  require_surface(input.source, "source of the surface fitting");
  require_surface(input.target, "target of the surface fitting");
  if (input.warped_vertices.cols() != input.source.vertices.cols())
    throw InvalidInput("surface fitting: " + std::to_string(input.source.vertices.cols()) +
                       " source vertices, but " + std::to_string(input.warped_vertices.cols()) +
                       " warped ones");
  if (!input.warped_vertices.allFinite())
    throw InvalidInput("surface fitting: a warped vertex is not finite; check the anchors");
  if (input.anchor_sources.cols() != input.anchor_targets.cols() ||
      input.anchor_sources.cols() != input.anchor_weights.size())
    throw InvalidInput("surface fitting: " + std::to_string(input.anchor_sources.cols()) +
                       " anchor sources, " + std::to_string(input.anchor_targets.cols()) +
                       " anchor targets and " + std::to_string(input.anchor_weights.size()) + " weights");
  if (input.anchor_sigmas.size() != 0 && (input.anchor_sigmas.size() != input.anchor_weights.size() ||
                                          !(input.anchor_sigmas.array() >= 0).all()))
    throw InvalidInput("surface fitting: " + std::to_string(input.anchor_weights.size()) +
                       " anchors need as many accuracies, each at least 0");
  require_consistent_patches(input, options);
  if (!(options.max_iterations >= 1))
    throw InvalidInput("surface fitting: max_iterations is " + std::to_string(options.max_iterations) +
                       ", but must be at least 1");
  if (!(options.epsilon >= 0))
    throw InvalidInput("surface fitting: epsilon is " + std::to_string(options.epsilon) +
                       ", but must be at least 0");
}

/// Of models that face opposite ways once the anchors have brought them together: that is one file's mistake,
/// unless both look out of what they enclose.
void require_unmirrored(const SurfaceFitInput& input) {
  const std::optional<bool> source = faces_outward(input.source), target = faces_outward(input.target);
  if (source && source == target)
    throw InvalidInput(
        "where the anchors place the source on the target, the outside of one lies against the inside of the "
        "other, so one model is a mirror image of the other, or the anchors' left and right are exchanged; "
        "mirror it back first, or name them anew");
}

}  // namespace

const SurfaceFitEntry& entry_of(SurfaceFitMethod method) {
  for (const SurfaceFitEntry& entry : surface_fits)
    if (entry.value == method) return entry;
  throw InvalidInput("surface fitting method " + std::to_string(static_cast<int>(method)) +
                     " is not in the table");
}

SurfaceFit fit_surface(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                       const Progress& progress) {
  require_consistent(input, options);
  const auto& entry = entry_of(options.method);
  const bool away = faces_away({input.warped_vertices, input.source.faces}, input.target);
  if (away) require_unmirrored(input);
  if (!away || !options.repair_models) return entry.fit(input, options, progress);
  const TriangleMesh target = flipped(input.target);
  SurfaceFit fit = entry.fit({input.source, input.warped_vertices, target, input.anchor_sources,
                              input.anchor_targets, input.anchor_weights, input.anchor_sigmas,
                              input.source_patches, input.target_patches, input.anchor_tested},
                             options, progress);
  fit.summary.target_flipped = true;
  return fit;
}

}  // namespace bespoke
