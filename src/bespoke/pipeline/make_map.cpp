#include "bespoke/pipeline/make_map.h"

#include <utility>

#include "bespoke/clearance/model_sides.h"
#include "bespoke/cloud/point_cloud_surface.h"
#include "bespoke/elastic/exact_map_io.h"
#include "bespoke/pipeline/detail/bake_map.h"
#include "bespoke/pipeline/detail/fit_map.h"
#include "bespoke/pipeline/detail/unusable_fit.h"
#include "bespoke/pipeline/detail/whole_fit.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

/// What the method of the surface fitting uses.
void put_surface_fit(const SurfaceFitOptions& options, Json& json) {
  json["surface_fit"] = name_of(surface_fits, options.method);
  json["epsilon"] = options.epsilon;
  if (!options.repair_models) json["mend_models"] = false;
  if (options.method == SurfaceFitMethod::deformation_graph) {
    json["boundaries"] = name_of(boundary_rules, options.boundaries);
    json["max_stretch"] = options.max_stretch;
    return;
  }
  json["max_iterations"] = options.max_iterations;
  const LaplacianAdditions& additions = options.laplacian;
  Json& laplacian = json["laplacian"];
  laplacian = {
      {"scaled_stiffness", additions.scaled_stiffness}, {"refuse_boundary", additions.refuse_boundary},
      {"free_unmatched", additions.free_unmatched},     {"hold_anchors", additions.hold_anchors},
      {"stop_at_rest", additions.stop_at_rest},         {"undo_turning_snaps", additions.undo_turning_snaps}};
  if (options.stiffness) laplacian["stiffness"] = *options.stiffness;
}

std::string recorded_options(const MakeMapOptions& options, const FittedMapping& fit, RotationPath path,
                             bool given_fitted) {
  Json json;
  json["path"] = name_of(rotation_paths, path);
  if (!given_fitted) put_surface_fit(options.fit.surface_fit, json);
  json["elastic"] = elastic_method(options.fit.elastic).name;
  json["lambda"] = options.fit.lambda;
  if (elastic_method(options.fit.elastic).takes_guides)
    json["guides"] =
        name_of(guided_maps, fit.summary.elastic.left_guides ? GuidedMaps::none : options.fit.guides);
  if (options.fit.elastic == ElasticMethod::finite_elements) json["max_squeeze"] = options.fit.max_squeeze;
  json["fit_tolerance"] = options.fit.fit_tolerance;
  json["contact_gap"] = options.fit.contact_offset;
  json["tolerance"] = options.bake.tolerance;
  if (options.bake.max_leaves && !options.bake.voxel_size)
    json["max_voxels"] = *options.bake.max_leaves * leaf_nodes;
  if (options.fit.steps) json["steps"] = *options.fit.steps;
  if (options.bake.precision == ValuePrecision::half) json["half"] = true;
  if (options.bake.voxel_size)
    json["voxel_size"] = *options.bake.voxel_size;
  else
    json["nodes"] = name_of(node_values, options.bake.nodes);
  return json.dump();
}

std::string recorded_stages(const FitSummary& summary, const Anchors& anchors) {
  Json stages = Json::array();
  for (StageJson& stage : stages_json(summary, anchors)) stages.push_back(std::move(stage.json));
  return stages.dump();
}

std::vector<AnchorRecord> anchor_records(const Anchors& anchors, const FittedMapping& fit) {
  std::vector<AnchorRecord> records;
  for (std::size_t i = 0; i < anchors.pairs.size(); ++i) {
    const AnchorPair& pair = anchors.pairs[i];
    const double sigma = fit.anchor_sigma.empty() ? pair.sigma.value_or(0) : fit.anchor_sigma[i];
    records.push_back({pair.name, pair.a, pair.b, pair.weight, fit.anchor_residual[i], sigma});
  }
  return records;
}

/// One step goes the same way on its flow as on its geodesic.
RotationPath path_of(const FittedMapping& fit, const MakeMapOptions& options) {
  if (fit.elastic->steps().size() > 1) return options.path.value_or(RotationPath::flow);
  const RotationPath path = options.path.value_or(RotationPath::geodesic);
  return path == RotationPath::flow ? RotationPath::geodesic : path;
}

AssetRecord make_record(const Problem& problem, const MakeMapOptions& options, const FittedMapping& fit) {
  AssetRecord record;
  record.unit = problem.anchors.unit.empty() ? "unknown" : problem.anchors.unit;
  record.elastic_method = elastic_method(options.fit.elastic).name;
  record.surface_fit_method =
      problem.fitted ? "given" : name_of(surface_fits, options.fit.surface_fit.method);
  record.lambda = options.fit.lambda;
  record.tolerance = options.bake.tolerance;
  record.bake_error = fit.summary.bake->error;
  record.options_json = recorded_options(options, fit, path_of(fit, options), problem.fitted != nullptr);
  record.stages_json = recorded_stages(fit.summary, problem.anchors);
  record.anchors = anchor_records(problem.anchors, fit);
  record.source = {content_hash(problem.source), bounding_box(problem.source.vertices)};
  record.target = {problem.target_cloud ? problem.target_cloud->hash : content_hash(problem.target),
                   bounding_box(problem.target.vertices)};
  return record;
}

/// With every byte that is not UTF-8 replaced: names in files may be in any encoding, those in JSON may not.
std::string valid_utf8(const std::string& text) {
  const std::string valid = Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
  return Json::parse(valid).get<std::string>();
}

FitSummary with_named_parts(FitSummary summary, const Problem& problem) {
  if (!summary.parts || !problem.read_source_groups) return summary;
  const std::vector<std::string> groups = problem.read_source_groups();
  for (LoosePart& part : summary.parts->loose)
    if (const auto vertex = static_cast<std::size_t>(part.first_vertex); vertex < groups.size())
      part.name = valid_utf8(groups[vertex]);
  return summary;
}

FitSummary with_bake(FitSummary summary, const BakedSteps& baked) {
  summary.bake = baked.whole;
  if (baked.steps.size() > 1) summary.bake_steps = baked.summaries;
  return summary;
}

Asset make_asset(const Problem& problem, const MakeMapOptions& options, const FittedMapping& fit,
                 std::vector<MapStep> steps) {
  Asset asset;
  asset.target_from_source = fit.target_from_source;
  asset.path = path_of(fit, options);
  asset.steps = std::move(steps);
  asset.record = make_record(problem, options, fit);
  if (options.keep_exact) asset.exact_map = serialize_exact_map(*fit.elastic);
  return asset;
}

}  // namespace

MakeMapOptions default_options(double source_diagonal, double size_scale) {
  const double on_target = size_scale * source_diagonal;
  MakeMapOptions options;
  options.fit.lambda = default_lambda * source_diagonal;
  options.fit.fit_tolerance = default_fit_tolerance * on_target;
  options.fit.contact_offset = default_contact_offset * on_target;
  options.bake.tolerance = default_tolerance * on_target;
  options.bake.max_leaves = default_max_leaves;
  return options;
}

MadeMap make_map(const Problem& problem, const MakeMapOptions& options, const Progress& progress) {
  // IV.A to IV.C: alignment and registration.
  const Registration registration = register_models(problem, options.fit, progress);

  // IV.D, IV.E: the elastic map.
  const TriangleMesh& registered = registered_mesh(registration, problem.source);
  const MapProblem to_fit = map_problem(registered, registration, options.fit);
  const MapFit fit = fit_map(to_fit, options.fit, progress);
  if (!problem.fitted)
    require_met_anchors(problem.anchors, anchor_residuals(fit, registration, problem.anchors), options.fit);

  // The bake takes another fit where this one's does not do.
  BakedFit baked = bake_map(fit, to_fit, options, progress);

  FittedMapping whole = whole_fit(problem, registration, baked.fit,
                                  map_findings(problem, registration, baked.fit, options.fit));
  whole.summary = with_bake(with_named_parts(std::move(whole.summary), problem), baked.baked);
  if (problem.target_cloud) whole.summary.cloud = *problem.target_cloud;

  MadeMap made;
  made.asset = make_asset(problem, options, whole, std::move(baked.baked.steps));
  progress.check();
  const Stopwatch watch;
  made.asset =
      with_model_sides(with_preview(std::move(made.asset), problem.source), problem.source, problem.target);
  made.preview_seconds = watch.seconds();
  made.exact = whole.elastic;
  made.fit = std::make_shared<const FittedMapping>(std::move(whole));
  return made;
}

}  // namespace bespoke
