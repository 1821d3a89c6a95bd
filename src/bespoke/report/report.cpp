#include "bespoke/report/report.h"

#include <sys/resource.h>

#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

/// The seconds after the name.
Json timed(const Json& stage, double seconds) {
  Json json = {{"name", stage["name"]}, {"seconds", seconds}};
  json.update(stage);
  return json;
}

Json model(const TriangleMesh& mesh) {
  Json json = {{"diagonal", diagonal(mesh.vertices)}};
  json.update(to_json(inspect_mesh(mesh)));
  return json;
}

Json unmet_vertices(const std::vector<UnmetVertex>& unmet) {
  Json list = Json::array();
  for (const UnmetVertex& vertex : unmet)
    list.push_back(
        {{"vertex", vertex.vertex}, {"residual", vertex.residual}, {"reason", to_string(vertex.reason)}});
  return list;
}

Json parts(const std::vector<PartSummary>& summaries) {
  Json list = Json::array();
  for (const PartSummary& part : summaries)
    list.push_back({{"name", part.name},
                    {"points", part.points},
                    {"scale", part.scale},
                    {"distance_from_map", to_json(part.distances)}});
  return list;
}

Json missed_json(const MissedDistances& missed) {
  return {{"samples", missed.samples},
          {"inside", missed.inside},
          {"breaches", missed.breaches},
          {"most", missed.most}};
}

Json clearance_json(const ProductClearance& clearance) {
  const ClearanceSummary& summary = clearance.summary;
  Json places = Json::array(), layers = Json::array();
  for (const MissedPlace& place : summary.places) {
    places.push_back({{"obstacle", place.obstacle},
                      {"place", {place.place[0], place.place[1], place.place[2]}},
                      {"missing", place.missing},
                      {"samples", place.samples},
                      {"has_space", place.has_space}});
    if (place.space) places.back()["space"] = *place.space;
  }
  Json passed_through = Json::array();
  for (const PassedThrough& passed : summary.passed_through)
    passed_through.push_back({{"other", passed.other},
                              {"place", {passed.place[0], passed.place[1], passed.place[2]}},
                              {"pairs", passed.pairs}});
  for (const LayerContact& layer : clearance.layers)
    layers.push_back({{"lower", layer.lower},
                      {"intersections_on_source", layer.before},
                      {"new_intersections", layer.after}});
  return {{"clear", clearance.is_clear()},
          {"samples", summary.looked_at},
          {"missed_before", missed_json(summary.before)},
          {"missed_after", missed_json(summary.after)},
          {"places", std::move(places)},
          {"moved", summary.moved},
          {"moves", to_json(summary.moves)},
          {"largest_bystander", summary.largest_bystander},
          {"strain_before", to_json(summary.strain_before)},
          {"strain_after", to_json(summary.strain_after)},
          {"new_self_intersections", summary.new_self_intersections},
          {"passed_through", std::move(passed_through)},
          {"layers", std::move(layers)},
          {"solve_seconds", summary.solve_seconds},
          {"check_seconds", summary.check_seconds}};
}

}  // namespace

std::size_t peak_memory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;  // Linux counts kibibytes
}

std::string fit_report(const Problem& input, const MadeMap& made, double seconds) {
  Json stages = Json::array();
  for (const StageJson& stage : stages_json(made.fit->summary, input.anchors))
    stages.push_back(timed(stage.json, stage.seconds));
  const BakeSummary& bake = *made.fit->summary.bake;
  stages.back()["refine_seconds"] = bake.refine_seconds;
  stages.back()["measure_seconds"] = bake.measure_seconds;
  stages.back()["repair_seconds"] = bake.repair_seconds;
  const Certificate certificate = whole_certificate(made.asset);
  Json certified = {{"name", "certificate"}};
  certified.update(to_json(certificate));
  stages.push_back(timed(certified, certificate.seconds));
  stages.push_back(timed({{"name", "preview"}}, made.preview_seconds));

  Json json = {{"command", "fit"},
               {"unit", made.asset.record.unit},
               {"source", model(input.source)},
               {"target", model(input.target)},
               {"options", Json::parse(made.asset.record.options_json)},
               {"anchor_residuals", to_json(made.fit->summary.elastic.anchor_residuals)},
               {"vertex_residuals", to_json(made.fit->summary.elastic.vertex_residuals)},
               {"unmet_vertices", unmet_vertices(made.fit->summary.elastic.unmet)},
               {"stages", std::move(stages)},
               {"voxels", voxel_count(made.asset)},
               {"seconds", seconds},
               {"peak_memory", peak_memory()}};
  if (!made.fit->confidence.empty()) json["confidence"] = to_json(summarize(made.fit->confidence));
  return json.dump(2) + "\n";
}

std::string apply_report(const std::vector<AppliedProduct>& products, const std::vector<double>& times,
                         double seconds, const std::optional<LayerOrder>& layers) {
  Json entries = Json::array();
  for (const AppliedProduct& product : products) {
    entries.push_back({{"name", product.name},
                       {"points", product.summary.points.points},
                       {"in_band", product.summary.points.in_band},
                       {"affine_only", product.summary.points.affine_only},
                       {"seconds", product.summary.points.seconds},
                       {"warnings", product.summary.warnings}});
    if (const auto& chord = product.summary.chord)
      entries.back()["chord_error"] = {{"length", chord->length},
                                       {"place", {chord->place[0], chord->place[1], chord->place[2]}},
                                       {"edges", chord->edges},
                                       {"splits", product.summary.splits}};
    if (product.clearance) entries.back()["clearance"] = clearance_json(*product.clearance);
    if (!product.summary.parts.empty()) entries.back()["parts"] = parts(product.summary.parts);
  }
  Json json = {{"command", "apply"},
               {"times", times},
               {"products", std::move(entries)},
               {"seconds", seconds},
               {"peak_memory", peak_memory()}};
  if (layers)
    json["layer_order"] = {{"names", layers->names},
                           {"found_on_source", layers->is_found},
                           {"interleaved", layers->interleaved},
                           {"circular", layers->is_circular}};
  return json.dump(2) + "\n";
}

}  // namespace bespoke
