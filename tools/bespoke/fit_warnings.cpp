#include "fit_warnings.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/anchor_checks/contradicting_anchors.h"
#include "bespoke/anchors/anchor_placement.h"
#include "bespoke/number_format.h"
#include "bespoke/pipeline/fit_mapping.h"

namespace bespoke::command {
namespace {

void warn_of_far_anchors(const RunContext& context, const std::string& role, const TriangleMesh& model,
                         const Points& anchors, const std::string& unit) {
  if (const std::optional<AnchorPlacement> far = far_placement(model, anchors))
    context.warn(role + ": " + to_string(*far) + "; give the model and its anchors in one unit" +
                     (unit.empty() ? "" : ", ") + unit,
                 Entry::anchors_far_away);
}

/// Pairs that the fit did not take as they were given, or that its map misses.
void warn_of_anchors(const RunContext& context, const FitSummary& summary, const Anchors& anchors) {
  const auto warn = [&](const std::string& text, Entry entry) {
    if (!text.empty()) context.warn(text, entry);
  };
  if (summary.accuracy.doubts_any()) warn(to_string(summary.accuracy, anchors), Entry::anchors_missed);
  if (summary.coarse) warn(to_string(summary.coarse->contradicting, anchors), Entry::contradicting_anchors);
  warn(to_string(summary.missed, anchors), Entry::anchors_missed);
}

/// Why the bake's error exceeds the tolerance, and what lowers it.
std::string cause_of_missed_tolerance(const BakeOptions& options, const BakeSummary& bake) {
  if (options.voxel_size) return "a smaller --voxel-size lowers it";
  if (bake.repaired_cells > 0)
    return "the repair of " + std::to_string(bake.repaired_cells) +
           " folded cells moved nodes there; no tolerance is met without folds where the map is that flat";
  if (!bake.relaxed.empty())
    return "it was relaxed in " + std::to_string(bake.relaxed.size()) +
           " regions, where the map is too steep for its share of voxels; --strict or a --tolerance of your "
           "own allows more voxels";
  return "the map is steep or jumps there; a smaller --tolerance allows finer voxels";
}

void warn_of_missed_tolerance(const RunContext& context, const BakeOptions& options,
                              const BakeSummary& bake) {
  if (bake.tolerance_met) return;
  char text[120];
  std::snprintf(text, sizeof text, "the largest error %.4g of the baked map exceeds the tolerance %.4g; ",
                bake.error.max, options.tolerance);
  context.warn(text + cause_of_missed_tolerance(options, bake), Entry::tolerance_missed);
}

constexpr double visible = 0.01;  // of the target's diagonal

/// Of a length on the target: "0.2, 1.5 % of the target's diagonal".
std::string visible_length(double length, double diagonal) {
  return format_number(length, 4) + ", " + format_number(100 * length / diagonal, 2) +
         " % of the target's diagonal";
}

/// A target of another kind, or elsewhere than its anchors, still gets some map.
void warn_of_uncovered_source(const RunContext& context, double diagonal, const SurfaceFitSummary& fit) {
  if (!(fit.after.median > visible * diagonal)) return;
  context.warn("half of the registered source lies " + visible_length(fit.after.median, diagonal) +
                   ", or more from the target; check that it is the right target, all of it, with anchors of "
                   "its own",
               Entry::source_off_the_target);
}

/// Such parts are known less well than by anchors.
void warn_of_inferred_parts(const RunContext& context, const CounterpartSummary& counterparts) {
  if (counterparts.taken)
    context.warn(to_string(counterparts) +
                     "; give pairs on those parts to be certain (bespoke anchors suggest says where)",
                 Entry::parts_far_from_anchors);
}

void warn_of_uncovered_target(const RunContext& context, const UncoveredArea& uncovered) {
  if (uncovered.is_notable())
    context.warn(to_string(uncovered) +
                     "; if the source has that part, give pairs on it (bespoke anchors suggest says where), "
                     "else exclude it by a patch",
                 Entry::target_uncovered);
}

/// A certified map may still not be the one that was wanted.
void warn_of_missed_vertices(const RunContext& context, double diagonal, std::vector<UnmetVertex> far) {
  std::erase_if(far, [&](const UnmetVertex& vertex) { return !(vertex.residual > visible * diagonal); });
  if (far.empty()) return;
  const auto worst = std::max_element(far.begin(), far.end(), [](const UnmetVertex& a, const UnmetVertex& b) {
    return a.residual < b.residual;
  });
  context.warn(to_string(far) + "; they are off by up to " + visible_length(worst->residual, diagonal) +
                   ", and products there with them; bespoke view shows where",
               Entry::vertices_missed);
}

}  // namespace

void warn_of_input(const RunContext& context, const TriangleMesh& source, const TriangleMesh& target,
                   const Anchors& anchors) {
  warn_of_far_anchors(context, "source", source, source_points(anchors), anchors.unit);
  warn_of_far_anchors(context, "target", target, target_points(anchors), anchors.unit);
}

void warn_of_missing_certificate(const RunContext& context, const Certificate& certificate) {
  if (certificate.is_bijection()) return;
  context.warn("the map is not proved to be one-to-one: " + to_string(certificate) +
                   "; products there may be turned inside out (bespoke check lists the places, fit "
                   "--require-certified refuses such maps)",
               Entry::not_proved);
}

void warn_of_misses(const RunContext& context, const Problem& input, const MakeMapOptions& options,
                    const MadeMap& made) {
  const FitSummary& summary = made.fit->summary;
  const double size = diagonal(input.target.vertices);
  warn_of_missing_certificate(context, whole_certificate(made.asset));
  warn_of_anchors(context, summary, input.anchors);
  if (summary.stretched.count > 0)
    context.warn(to_string(summary.stretched) +
                     "; look at the anchors and curves there (bespoke pick), and whether the target has that "
                     "part at all",
                 Entry::over_stretched);
  if (summary.parts)
    context.warn(to_string(*summary.parts) +
                     "; if the target has such a part, give an anchor on it, else leave it out of the source",
                 Entry::parts_without_counterpart);
  if (summary.surface) warn_of_uncovered_source(context, size, *summary.surface);
  if (summary.counterparts) warn_of_inferred_parts(context, *summary.counterparts);
  if (summary.uncovered) warn_of_uncovered_target(context, *summary.uncovered);
  warn_of_missed_vertices(context, size, summary.elastic.unmet);
  warn_of_missed_tolerance(context, options.bake, *summary.bake);
}

}  // namespace bespoke::command
