#include "bespoke/registration/fit_summary.h"

#include <cstdio>
#include <numbers>

#include "bespoke/anchors/size_ratio.h"
#include "bespoke/number_format.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

std::string to_string(const SeamSummary& summary) {
  return "vertices joined at seams: " + std::to_string(summary.source) + " of the source, " +
         std::to_string(summary.target) + " of the target";
}

RigidSummary rigid_summary(const RigidTransform& target_from_source, const Points& sources,
                           const Points& targets) {
  RigidSummary summary;
  summary.rotation = rotation_angle(target_from_source);
  const Similarity similarity = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols()));
  if (tells_two_units(similarity.scale)) {
    summary.scale = similarity.scale;
    summary.residuals = summarize(distances(similarity * sources, targets));
  } else {
    summary.residuals = summarize(distances(target_from_source * sources, targets));
  }
  return summary;
}

std::string to_string(const RigidSummary& summary) {
  char line[300];
  std::snprintf(line, sizeof line, "%zu %s, turned by %.4g degrees, ", summary.residuals.count,
                summary.by_vertices ? "vertices" : "anchors", summary.rotation * 180 / std::numbers::pi);
  std::string text = line;
  if (summary.scale) text += "scaled by " + format_number(*summary.scale, 4) + ", ";
  std::snprintf(line, sizeof line, "residual p95 %.4g max %.4g", summary.residuals.p95,
                summary.residuals.max);
  return text + line;
}

std::string to_string(const CoarseSummary& summary, const Anchors& anchors) {
  char text[200];
  std::snprintf(text, sizeof text, "%zu anchors, residual p95 %.4g max %.4g", summary.residuals.count,
                summary.residuals.p95, summary.residuals.max);
  std::string line = text;
  if (summary.regularised)
    line += "; their spread (" + format_number(summary.anchor_widths, 3) +
            ") does not determine an affine map: it starts near a similarity";
  if (summary.turned_by_surfaces) line += ", turned about their line by the surfaces";
  if (!summary.audit.suspicious.empty()) line += "; suspicious: " + to_string(summary.audit, anchors);
  return line;
}

std::string to_string(const CounterpartSummary& summary) {
  return std::to_string(summary.displaced) + " of " + std::to_string(summary.found) +
         " places far from all anchors were registered elsewhere than geodesic distances put them; " +
         (summary.taken ? "these now count as well" : "with these as well the target is explained no better");
}

namespace {

std::string to_string(const ElasticFindings& found) {
  return std::visit([](const auto& summary) { return bespoke::to_string(summary); }, found);
}

std::string motion_text(const RegionalMotion& motion) {
  char text[120];
  std::snprintf(text, sizeof text, "parts rotate by %.3g degrees and stretch by %.3g",
                motion.turn * 180 / std::numbers::pi, motion.stretch);
  return text;
}

std::string steps_text(const ElasticSummary& summary) {
  std::vector<std::string> reasons;
  if (step_count(summary.motion) > 1) reasons.push_back(motion_text(summary.motion));
  if (summary.divided_where_missed) reasons.emplace_back("fewer miss vertices");
  if (summary.divided_steps > 0)
    reasons.push_back(std::to_string(summary.divided_steps) + " folded when baked or were foreseen to");
  std::string line = std::to_string(summary.later_steps.size() + 1) + " steps";
  for (std::size_t i = 0; i < reasons.size(); ++i) line += (i == 0 ? ", since " : " and ") + reasons[i];
  line += "; 1: " + to_string(summary.found);
  for (std::size_t k = 0; k < summary.later_steps.size(); ++k)
    line += "; " + std::to_string(k + 2) + ": " + to_string(summary.later_steps[k]);
  return line;
}

}  // namespace

std::string to_string(const ElasticSummary& summary) {
  std::string line = std::string(elastic_method(summary.method).name) + ": " +
                     (summary.later_steps.empty() ? to_string(summary.found) : steps_text(summary));
  char text[300];
  std::snprintf(text, sizeof text, "; vertices p95 %.4g max %.4g, anchors max %.4g off",
                summary.vertex_residuals.p95, summary.vertex_residuals.max, summary.anchor_residuals.max);
  line += text;
  if (summary.left_guides) line += "; without guides, which took it off the surface or beyond its voxels";
  if (!summary.unmet.empty()) line += "; " + to_string(summary.unmet);
  if (summary.unreferenced_vertices > 0)
    line += "; " + std::to_string(summary.unreferenced_vertices) + " unreferenced vertices left out";
  if (summary.duplicate_vertices > 0)
    line += "; " + std::to_string(summary.duplicate_vertices) + " duplicate vertices merged";
  if (summary.anchors_off_surface > 0)
    line += "; " + std::to_string(summary.anchors_off_surface) + " anchors off the surface" +
            (summary.meets_anchors_off_surface ? " matched as points" : " left out: p-FFD uses faces only");
  return line;
}

std::string to_string(const std::vector<CurveSummary>& curves) {
  std::string line;
  for (const CurveSummary& curve : curves) {
    line += (line.empty() ? "" : ", ") +
            (curve.name.empty() ? std::string("a curve") : '"' + curve.name + '"') + " at most " +
            format_number(curve.largest_distance, 4) + " off";
  }
  return line;
}

std::string to_string(const std::vector<PatchSummary>& patches) {
  std::string line;
  for (const PatchSummary& patch : patches) {
    line +=
        (line.empty() ? "" : ", ") + (patch.name.empty() ? std::string("a patch") : '"' + patch.name + '"');
    if (patch.exclude) line += " excluded";
    line += " (" + std::to_string(patch.source_faces) + " faces on the source, " +
            std::to_string(patch.target_faces) + " on the target)";
    if (patch.largest_distance)
      line += " border at most " + format_number(*patch.largest_distance, 4) + " off";
  }
  return line;
}

std::vector<StageLine> stage_lines(const FitSummary& summary, const Anchors& anchors) {
  std::vector<StageLine> lines;
  if (summary.cloud) lines.push_back({"cloud", to_string(*summary.cloud)});
  if (has_any(summary.seams)) lines.push_back({"seams", to_string(summary.seams)});
  if (summary.parts) lines.push_back({"parts", to_string(*summary.parts)});
  if (summary.leading_vertices > 0)
    lines.push_back({"decimation", std::to_string(summary.leading_vertices) +
                                       " vertices are registered, the others follow them"});
  if (summary.unanchored) lines.push_back({"alignment", to_string(*summary.unanchored)});
  const std::string accuracy = to_string(summary.accuracy, anchors);
  if (!accuracy.empty()) lines.push_back({"accuracy", accuracy});
  if (!summary.matched_parts.empty()) lines.push_back({"matched parts", summary.matched_parts});
  lines.push_back({"rigid", to_string(summary.rigid)});
  if (summary.coarse) lines.push_back({"coarse", to_string(*summary.coarse, anchors)});
  if (summary.counterparts) lines.push_back({"counterparts", to_string(*summary.counterparts)});
  lines.push_back({"surface-fit", summary.surface ? std::string(entry_of(summary.surface_method).name) +
                                                        ": " + to_string(*summary.surface)
                                                  : "given: the fitted mesh as it is"});
  if (summary.uncovered && summary.uncovered->is_notable())
    lines.push_back({"uncovered", to_string(*summary.uncovered)});
  if (summary.contact) lines.push_back({"contact", to_string(*summary.contact)});
  lines.push_back({"elastic", to_string(summary.elastic)});
  if (!summary.missed.empty()) lines.push_back({"missed", to_string(summary.missed, anchors)});
  if (summary.stretched.count > 0) lines.push_back({"stretched", to_string(summary.stretched)});
  if (!summary.curves.empty()) lines.push_back({"curves", to_string(summary.curves)});
  if (!summary.patches.empty()) lines.push_back({"patches", to_string(summary.patches)});
  if (summary.bake) lines.push_back({"bake", to_string(*summary.bake)});
  return lines;
}

}  // namespace bespoke
