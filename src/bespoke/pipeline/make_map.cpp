#include "bespoke/pipeline/make_map.h"

#include <optional>
#include <utility>

#include "bespoke/elastic/exact_map_io.h"
#include "bespoke/pipeline/bake_steps.h"
#include "bespoke/pipeline/fit_elastic_map.h"
#include "bespoke/pipeline/summary_json.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

Json laplacian_json(const SurfaceFitOptions& options) {
  const LaplacianAdditions& additions = options.laplacian;
  Json json = {
      {"scaled_stiffness", additions.scaled_stiffness}, {"refuse_boundary", additions.refuse_boundary},
      {"free_unmatched", additions.free_unmatched},     {"hold_anchors", additions.hold_anchors},
      {"stop_at_rest", additions.stop_at_rest},         {"undo_turning_snaps", additions.undo_turning_snaps}};
  if (options.stiffness) json["stiffness"] = *options.stiffness;
  return json;
}

std::string recorded_options(const MakeMapOptions& options, const FittedMapping& fit, RotationPath path,
                             bool given_fitted) {
  Json json;
  json["path"] = name_of(rotation_paths, path);
  if (!given_fitted) {
    json["surface_fit"] = name_of(surface_fits, options.fit.surface_fit.method);
    json["boundaries"] = name_of(boundary_rules, options.fit.surface_fit.boundaries);
    json["max_stretch"] = options.fit.surface_fit.max_stretch;
    json["max_iterations"] = options.fit.surface_fit.max_iterations;
    json["epsilon"] = options.fit.surface_fit.epsilon;
    if (!options.fit.surface_fit.mend_models) json["mend_models"] = false;
    if (options.fit.surface_fit.method == SurfaceFitMethod::laplacian)
      json["laplacian"] = laplacian_json(options.fit.surface_fit);
  }
  json["elastic"] = elastic_method(options.fit.elastic).name;
  json["lambda"] = options.fit.lambda;
  if (elastic_method(options.fit.elastic).takes_guides)
    json["guides"] =
        name_of(guided_maps, fit.summary.elastic.left_guides ? GuidedMaps::none : options.fit.guides);
  json["fit_tolerance"] = options.fit.fit_tolerance;
  json["contact_gap"] = options.fit.contact_gap;
  json["tolerance"] = options.bake.tolerance;
  if (options.bake.max_leaves) json["max_voxels"] = *options.bake.max_leaves * leaf_nodes;
  if (options.fit.steps) json["steps"] = *options.fit.steps;
  if (options.bake.precision == ValuePrecision::half) json["half"] = true;
  if (options.bake.voxel_size) json["voxel_size"] = *options.bake.voxel_size;
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

/// Whether a single step that folds may become a chain: where nobody asked for one step or its voxels, and
/// the map itself does not fold.
bool may_become_chain(const MakeMapOptions& options) {
  return !options.fit.steps && !options.bake.voxel_size &&
         elastic_method(options.fit.elastic).keeps_orientation;
}

/// Bakes the fitted map; a step that folds although it was mended is halved, as are its halves, and the steps
/// after it kept.
BakedSteps bake_fitted(FittedMapping& fit, const MakeMapInput& input, const MakeMapOptions& options,
                       const Progress& progress) {
  // Of a step and its parts: what folds after those on the path folds however small its motion is.
  constexpr int on_path = 3, by_layers = 2;
  constexpr std::size_t most_divided_steps = 16;  // each has cost the bake that folded
  const bool has_layers = bool{elastic_method(options.fit.elastic).composition};
  const int most_halvings =
      fit.plan || may_become_chain(options) ? on_path + (has_layers ? by_layers : 0) : 0;
  std::vector<int> halvings(fit.elastic->steps().size(), most_halvings);
  BakedSteps last;
  for (;;) {
    std::vector<bool> divisible;
    for (std::size_t k = 0; k < halvings.size(); ++k)
      divisible.push_back(halvings[k] > 0 && is_divisible(fit, k) &&
                          fit.summary.elastic.divided_steps < most_divided_steps);
    BakedSteps baked = bake_steps(*fit.elastic, fit.step_sources, input.source.faces, options.bake, divisible,
                                  std::move(last), progress);
    if (!is_to_be_divided(baked, divisible)) return baked;
    const std::size_t folded = fit.elastic->steps().size() - baked.steps.size();
    const bool leave_path = has_layers && halvings[folded] <= by_layers;
    divide_step(fit, input.source, input.anchors, options.fit, folded, leave_path, progress);
    const int left = --halvings[folded];
    halvings.insert(halvings.begin() + static_cast<std::ptrdiff_t>(folded), left);
    baked.steps.erase(baked.steps.begin());
    baked.summaries.erase(baked.summaries.begin());
    last = std::move(baked);
  }
}

/// The same, but for guides that take a map of one step beyond its share of voxels: the tolerance comes
/// first.
BakedSteps bake_within_share(FittedMapping& fit, const MakeMapInput& input, const MakeMapOptions& options,
                             const Progress& progress) {
  BakedSteps baked = bake_fitted(fit, input, options, progress);
  if (baked.whole.relaxed.empty() || baked.steps.size() > 1) return baked;
  std::optional<FittedMapping> unguided =
      refitted_without_guides(fit, input.source, input.anchors, options.fit, progress);
  if (!unguided) return baked;
  BakedSteps within = bake_fitted(*unguided, input, options, progress);
  if (!within.whole.relaxed.empty()) return baked;
  fit = std::move(*unguided);
  return within;
}

AssetRecord make_record(const MakeMapInput& input, const MakeMapOptions& options, const FittedMapping& fit) {
  AssetRecord record;
  record.unit = input.anchors.unit.empty() ? "unknown" : input.anchors.unit;
  record.elastic_method = elastic_method(options.fit.elastic).name;
  record.surface_fit_method = input.fitted ? "given" : name_of(surface_fits, options.fit.surface_fit.method);
  record.lambda = options.fit.lambda;
  record.tolerance = options.bake.tolerance;
  record.bake_error = fit.summary.bake->error;
  record.options_json = recorded_options(options, fit, path_of(fit, options), input.fitted != nullptr);
  record.stages_json = recorded_stages(fit.summary, input.anchors);
  record.anchors = anchor_records(input.anchors, fit);
  record.source = {content_hash(input.source), bounding_box(input.source.vertices)};
  record.target = {input.target_cloud ? input.target_cloud->hash : content_hash(input.target),
                   bounding_box(input.target.vertices)};
  return record;
}

}  // namespace

MakeMapOptions default_options(double source_diagonal) {
  MakeMapOptions options;
  options.fit.lambda = default_lambda * source_diagonal;
  options.fit.fit_tolerance = default_fit_tolerance * source_diagonal;
  options.fit.contact_gap = default_contact_gap * source_diagonal;
  options.bake.tolerance = default_tolerance * source_diagonal;
  options.bake.max_leaves = default_max_leaves;
  return options;
}

MadeMap make_map(const MakeMapInput& input, const MakeMapOptions& options, const Progress& progress) {
  MadeMap made;
  made.fit = input.fitted
                 ? fit_mapping_to_fitted(input.source, *input.fitted, input.anchors, options.fit, progress)
                 : fit_mapping(input.source, input.target, input.anchors, options.fit, progress);
  if (input.target_cloud) made.fit.summary.cloud = *input.target_cloud;
  BakedSteps baked = bake_within_share(made.fit, input, options, progress);
  made.fit.summary.bake = std::move(baked.whole);
  if (baked.steps.size() > 1) made.fit.summary.bake_steps = std::move(baked.summaries);

  Asset& asset = made.asset;
  asset.target_from_source = made.fit.target_from_source;
  asset.path = path_of(made.fit, options);
  asset.steps = std::move(baked.steps);
  asset.record = make_record(input, options, made.fit);
  if (options.keep_exact) asset.exact_map = serialize_exact_map(*made.fit.elastic);

  progress.check();
  const Stopwatch watch;
  asset = with_preview(std::move(asset), input.source);
  made.preview_seconds = watch.seconds();
  return made;
}

}  // namespace bespoke
