#include "bespoke/pipeline/summary_json.h"

#include <numbers>
#include <utility>

namespace bespoke {

Json to_json(const Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

Json to_json(const Matrix3& matrix) {
  Json rows = Json::array();
  for (int row = 0; row < 3; ++row) rows.push_back(to_json(Vector3(matrix.row(row).transpose())));
  return rows;
}

Json to_json(const Box& box) {
  return {{"min", to_json(Vector3(box.min()))}, {"max", to_json(Vector3(box.max()))}};
}

Json to_json(const Statistics& statistics) {
  return {{"count", statistics.count}, {"min", statistics.min}, {"median", statistics.median},
          {"p95", statistics.p95},     {"p99", statistics.p99}, {"max", statistics.max}};
}

Json to_json(const MeshFindings& findings) {
  return {{"vertices", findings.vertices},
          {"faces", findings.faces},
          {"components", findings.components},
          {"boundary_edges", findings.boundary_edges},
          {"non_manifold_edges", findings.non_manifold_edges},
          {"inconsistent_edges", findings.inconsistent_edges},
          {"degenerate_faces", findings.degenerate_faces},
          {"unreferenced_vertices", findings.unreferenced_vertices},
          {"duplicate_vertices", findings.duplicate_vertices}};
}

Json to_json(const PointCloudSummary& summary) {
  return {{"points", summary.points},
          {"spacing", summary.spacing},
          {"duplicate_points", summary.duplicates},
          {"isolated_points", summary.isolated},
          {"contradicting_normals", summary.contradicting},
          {"vertices", summary.vertices},
          {"faces", summary.faces},
          {"distances", to_json(summary.distances)}};
}

Json to_json(const BakeSummary& summary) {
  Json levels = Json::array();
  for (const BakeLevelSummary& level : summary.levels)
    levels.push_back({{"voxel_size", level.voxel_size}, {"leaves", level.leaves}, {"voxels", level.voxels}});
  Json json = {{"levels", std::move(levels)},
               {"error", to_json(summary.error)},
               {"error_random_points", summary.error_random_points},
               {"error_surface_points", summary.error_surface_points},
               {"surface_cells", summary.surface_cells},
               {"tolerance_met", summary.tolerance_met},
               {"turned_faces", summary.misoriented_faces},
               {"refined_folds", summary.refined_folds},
               {"repaired_cells", summary.repaired_cells},
               {"repair_cost", summary.repair_cost},
               {"folded_cells", summary.folded_cells},
               {"evaluated_points", summary.evaluated_points},
               {"peak_bytes", summary.peak_bytes}};
  for (const RelaxedRegion& region : summary.relaxed)
    json["relaxed"].push_back({{"box", to_json(region.box)}, {"error", region.error}});
  return json;
}

Json to_json(const Certificate& certificate) {
  Json places = Json::array();
  for (const FoldedCell& cell : certificate.places)
    places.push_back(
        {{"level", cell.level}, {"center", to_json(cell.center)}, {"determinant", cell.determinant}});
  return {{"bijection", certificate.is_bijection()},
          {"certified", certificate.certified},
          {"undecided", certificate.undecided},
          {"folded", certificate.folded},
          {"min_determinant", certificate.min_determinant},
          {"affine_determinant", certificate.affine_determinant},
          {"places", std::move(places)}};
}

Json to_json(const UnanchoredSummary& summary) {
  const AlignmentSummary& alignment = summary.alignment;
  Json json = {{"anchors", "none"},
               {"confidence", alignment.confidence()},
               {"misfit", alignment.misfit},
               {"scale", alignment.scale},
               {"residual", alignment.residual},
               {"bending", alignment.bending},
               {"matched", alignment.matched},
               {"asymmetry", alignment.asymmetry},
               {"same_boundaries", alignment.same_boundaries},
               {"start", summary.from_deformed ? "deformed" : "similarity"},
               {"both_directions", summary.of_both_directions},
               {"disagreement", summary.disagreement},
               {"distance", summary.placement.distance},
               {"distortion", summary.placement.distortion},
               {"covered", summary.placement.covered}};
  if (alignment.next_misfit) json["next_misfit"] = *alignment.next_misfit;
  if (alignment.mirror_misfit) json["mirror_misfit"] = *alignment.mirror_misfit;
  return json;
}

Json to_json(const RigidSummary& summary) {
  Json json = {{"pairs_of", summary.by_vertices ? "vertices" : "anchors"},
               {"pairs", summary.residuals.count},
               {"rotation_degrees", summary.rotation * 180 / std::numbers::pi},
               {"residual", to_json(summary.residuals)}};
  // Only where there is one: the records of all other fits stay as they were.
  if (summary.scale) json["scale"] = *summary.scale;
  return json;
}

Json to_json(const AnchorAccuracy& accuracy, const Anchors& anchors) {
  Json outliers = Json::array(), swapped = Json::array(), left_out = Json::array(), given_way = Json::array();
  for (const OutlierAnchor& anchor : accuracy.outliers)
    outliers.push_back(
        {{"index", anchor.index}, {"name", anchors.pairs[anchor.index].name}, {"distance", anchor.distance}});
  for (const RejectedAnchor& anchor : accuracy.left_out)
    left_out.push_back(
        {{"index", anchor.index}, {"name", anchors.pairs[anchor.index].name}, {"distance", anchor.distance}});
  for (const GivenWayAnchor& anchor : accuracy.given_way)
    given_way.push_back(
        {{"index", anchor.index}, {"name", anchors.pairs[anchor.index].name}, {"sigma", anchor.sigma}});
  for (const SwappedAnchors& pair : accuracy.swapped)
    swapped.push_back({{"indices", {pair.first, pair.second}},
                       {"names", {anchors.pairs[pair.first].name, anchors.pairs[pair.second].name}},
                       {"energy_ratio", pair.energy_ratio}});
  return {{"estimated", accuracy.estimated},         {"sigma", accuracy.sigma},
          {"slipped_anchors", std::move(outliers)},  {"swapped_anchors", std::move(swapped)},
          {"left_out_anchors", std::move(left_out)}, {"given_way_anchors", std::move(given_way)}};
}

Json to_json(const std::vector<MissedAnchor>& missed, const Anchors& anchors) {
  Json list = Json::array();
  for (const MissedAnchor& anchor : missed)
    list.push_back({{"index", anchor.index},
                    {"name", anchors.pairs[anchor.index].name},
                    {"residual", anchor.residual},
                    {"sigma", anchor.sigma}});
  return {{"anchors", std::move(list)}};
}

Json to_json(const StretchedEdges& stretched) {
  Json places = Json::array();
  for (const Vector3& place : stretched.places) places.push_back(to_json(place));
  return {{"edges", stretched.count}, {"max_factor", stretched.max_factor}, {"places", std::move(places)}};
}

Json to_json(const CoarseSummary& summary, const Anchors& anchors) {
  Json suspicious = Json::array();
  for (const SuspiciousAnchor& anchor : summary.audit.suspicious) {
    Json entry = {{"index", anchor.index}, {"name", anchor.name}, {"distance", anchor.distance}};
    if (anchor.swapped_with) entry["swapped_with"] = *anchor.swapped_with;
    suspicious.push_back(std::move(entry));
  }
  Json contradicting = Json::array();
  for (const ContradictingAnchors& pair : summary.contradicting)
    contradicting.push_back({{"indices", {pair.first, pair.second}},
                             {"names", {anchors.pairs[pair.first].name, anchors.pairs[pair.second].name}},
                             {"apart", pair.source_distance},
                             {"asked", pair.target_difference}});
  return {{"pairs", summary.residuals.count},
          {"residual", to_json(summary.residuals)},
          {"regularised", summary.regularised},
          {"turned_by_surfaces", summary.turned_by_surfaces},
          {"suspicious_anchors", std::move(suspicious)},
          {"contradicting_anchors", std::move(contradicting)}};
}

Json to_json(const ContactSummary& summary) {
  return {{"touching_vertices", summary.touching},
          {"deepest", summary.deepest},
          {"released_vertices", summary.released.size()},
          {"iterations", summary.iterations},
          {"left", summary.left}};
}

Json to_json(const SurfaceFitSummary& summary, SurfaceFitMethod method) {
  Json json = {{"method", entry_of(method).name},
               {"before", to_json(summary.before)},
               {"after", to_json(summary.after)},
               {"iterations", summary.iterations},
               {"stop_reason", to_string(summary.stop_reason)},
               {"unmatched_vertices", summary.unmatched_vertices},
               {"off_surface_anchors", summary.off_surface_anchors},
               {"stiffness", summary.stiffness},
               {"similarity_suffices", summary.similarity_suffices},
               {"matched_boundaries", summary.matched_boundaries},
               {"cavity_vertices", summary.cavity_vertices},
               {"stretched_vertices", summary.stretched_vertices},
               {"mended_vertices", summary.repaired_vertices}};
  // Only where there are any: the records of all other fits stay as they were.
  if (!summary.excluded_vertices.empty()) json["excluded_vertices"] = summary.excluded_vertices;
  if (summary.target_flipped) json["target_turned_over"] = true;
  if (summary.rigidity > 1) json["rigidity"] = summary.rigidity;
  if (summary.posed_by_anchors) json["posed_by_anchors_degrees"] = summary.anchor_turn_degrees;
  return json;
}

namespace {

void add_figures(const ElasticFindings& found, Json& json) {
  for (const Figure& figure : std::visit([](const auto& summary) { return figures(summary); }, found))
    std::visit([&](const auto& value) { json[figure.name] = value; }, figure.value);
}

/// With what was found of every step of a chain.
Json bake_json(const FitSummary& summary) {
  Json json = to_json(*summary.bake);
  for (const BakeSummary& step : summary.bake_steps) json["steps"].push_back(to_json(step));
  return json;
}

}  // namespace

Json to_json(const ElasticSummary& summary) {
  Json json = {{"method", elastic_method(summary.method).name}};
  add_figures(summary.found, json);
  json["lambda"] = summary.lambda;
  json["vertex_residual"] = to_json(summary.vertex_residuals);
  json["unmet_vertices"] = summary.unmet.size();
  json["anchor_residual"] = to_json(summary.anchor_residuals);
  json["unreferenced_vertices"] = summary.unreferenced_vertices;
  json["duplicate_vertices"] = summary.duplicate_vertices;
  // Only where there are any: the records of all other fits stay as they were.
  if (summary.anchors_off_surface > 0)
    json[summary.meets_anchors_off_surface ? "anchors_off_surface" : "anchors_off_surface_left_out"] =
        summary.anchors_off_surface;
  if (summary.left_guides) json["left_guides"] = true;
  if (summary.later_steps.empty()) return json;
  json["turn"] = summary.motion.turn;
  json["stretch"] = summary.motion.stretch;
  if (summary.divided_where_missed) json["divided_where_missed"] = true;
  if (summary.divided_steps > 0) json["divided_steps"] = summary.divided_steps;
  for (const ElasticFindings& found : summary.later_steps)
    add_figures(found, json["later_steps"].emplace_back());
  return json;
}

Json to_json(const LoosePartsSummary& summary) {
  Json list = Json::array();
  for (const LoosePart& part : summary.loose)
    list.push_back({{"name", part.name},
                    {"component", part.component},
                    {"first_vertex", part.first_vertex},
                    {"vertices", part.vertices},
                    {"faces", part.faces}});
  return {{"parts", summary.parts}, {"loose_parts", std::move(list)}};
}

Json to_json(const std::vector<CurveSummary>& curves) {
  Json list = Json::array();
  for (const CurveSummary& curve : curves)
    list.push_back({{"name", curve.name}, {"largest_distance", curve.largest_distance}});
  return {{"curves", std::move(list)}};
}

Json to_json(const std::vector<PatchSummary>& patches) {
  Json list = Json::array();
  for (const PatchSummary& patch : patches) {
    Json json = {{"name", patch.name},
                 {"exclude", patch.exclude},
                 {"source_faces", patch.source_faces},
                 {"target_faces", patch.target_faces}};
    if (patch.largest_distance) json["largest_distance"] = *patch.largest_distance;
    list.push_back(std::move(json));
  }
  return {{"patches", std::move(list)}};
}

std::vector<StageJson> stages_json(const FitSummary& summary, const Anchors& anchors) {
  std::vector<StageJson> stages;
  const auto add = [&](const char* name, const Json& found, double seconds) {
    Json json = {{"name", name}};
    json.update(found);
    stages.push_back({std::move(json), seconds});
  };
  if (summary.cloud) add("cloud", to_json(*summary.cloud), summary.cloud->seconds);
  if (has_any(summary.seams))
    add("seams",
        {{"joined_source_vertices", summary.seams.source}, {"joined_target_vertices", summary.seams.target}},
        0);
  if (summary.parts) add("parts", to_json(*summary.parts), 0);
  if (summary.leading_vertices > 0) add("decimation", {{"registered_vertices", summary.leading_vertices}}, 0);
  if (summary.unanchored) add("alignment", to_json(*summary.unanchored), summary.unanchored->seconds);
  // Only where it found something: the records of all other fits stay as they were.
  if (!to_string(summary.accuracy, anchors).empty()) add("accuracy", to_json(summary.accuracy, anchors), 0);
  if (!summary.matched_parts.empty()) add("matched-parts", {{"text", summary.matched_parts}}, 0);
  add("rigid", to_json(summary.rigid), summary.rigid.seconds);
  if (summary.coarse) add("coarse", to_json(*summary.coarse, anchors), summary.coarse->seconds);
  // Only where there is any: the records of all other fits stay as they were.
  if (summary.counterparts)
    add("counterparts",
        {{"found", summary.counterparts->found},
         {"elsewhere", summary.counterparts->displaced},
         {"taken", summary.counterparts->taken}},
        summary.counterparts->seconds);
  if (summary.surface)
    add("surface-fit", to_json(*summary.surface, summary.surface_method), summary.surface->seconds);
  else
    add("surface-fit", {{"method", "given"}}, 0);
  // Only where there is any: the records of all other fits stay as they were.
  if (summary.uncovered && summary.uncovered->is_notable())
    add("bare",
        {{"share", summary.uncovered->share},
         {"distance", summary.uncovered->distance},
         {"farthest", to_json(summary.uncovered->farthest)}},
        0);
  if (summary.contact) add("contact", to_json(*summary.contact), summary.contact->seconds);
  add("elastic", to_json(summary.elastic), summary.elastic.seconds);
  if (!summary.missed.empty()) add("missed", to_json(summary.missed, anchors), 0);
  if (summary.stretched.count > 0) add("stretched", to_json(summary.stretched), 0);
  if (!summary.curves.empty()) add("curves", to_json(summary.curves), 0);
  if (!summary.patches.empty()) add("patches", to_json(summary.patches), 0);
  if (summary.bake) add("bake", bake_json(summary), summary.bake->seconds);
  return stages;
}

}  // namespace bespoke
