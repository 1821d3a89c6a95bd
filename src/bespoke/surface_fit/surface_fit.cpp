#include "bespoke/surface_fit/surface_fit.h"

#include <cstdio>

namespace bespoke {

const char* to_string(StopReason reason) {
  switch (reason) {
    case StopReason::converged:
      return "converged";
    case StopReason::stagnated:
      return "stagnated";
    case StopReason::iteration_cap:
      return "stopped at the iteration cap";
    case StopReason::unprinted_cap:
      return "stopped at the iteration cap, which the paper does not have";
  }
  return "";
}

std::string to_string(const SurfaceFitSummary& summary) {
  char text[400];
  std::snprintf(text, sizeof text,
                "distance to target p95 %.4g max %.4g (before: p95 %.4g max %.4g), %d iterations, %s, "
                "%zu unmatched vertices, %.2f s",
                summary.after.p95, summary.after.max, summary.before.p95, summary.before.max,
                summary.iterations, to_string(summary.stop_reason), summary.unmatched_vertices,
                summary.seconds);
  std::string line = text;
  if (summary.off_surface_anchors > 0)
    line += ", " + std::to_string(summary.off_surface_anchors) + " anchors off the surface left to the map";
  if (!summary.anchors_given_way.empty())
    line += ", " + std::to_string(summary.anchors_given_way.size()) +
            " anchors gave way, since meeting them would stretch the surface too much";
  if (summary.target_flipped) line += ", the target's faces flipped to match the source's";
  if (summary.similarity_suffices) line += ", one similarity explains the target";
  if (summary.posed_by_anchors) {
    char turn[80];
    std::snprintf(turn, sizeof turn, ", posed by the anchors first (rotations of %.0f degrees)",
                  summary.anchor_turn_degrees);
    line += turn;
  }
  if (summary.posed_by_anchors || summary.rigidity > 1) {
    char rigidity[80];
    std::snprintf(rigidity, sizeof rigidity, ", rigidity %.2g", summary.rigidity);
    line += rigidity;
  }
  if (summary.matched_boundaries > 0)
    line += ", open boundaries taken for the same cut: " + std::to_string(summary.matched_boundaries);
  if (!summary.cavity_vertices.empty())
    line +=
        ", " + std::to_string(summary.cavity_vertices.size()) + " vertices in cavities that the target lacks";
  if (!summary.excluded_vertices.empty())
    line += ", " + std::to_string(summary.excluded_vertices.size()) +
            " vertices without counterpart since patches exclude it";
  if (!summary.stretched_vertices.empty())
    line += ", " + std::to_string(summary.stretched_vertices.size()) + " over-stretched vertices";
  if (summary.repaired_vertices > 0)
    line += ", " + std::to_string(summary.repaired_vertices) + " over-stretched vertices reset";
  return line;
}

}  // namespace bespoke
