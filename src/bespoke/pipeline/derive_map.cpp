#include "bespoke/pipeline/derive_map.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bespoke/asset/model_distances.h"
#include "bespoke/asset/source_surface.h"
#include "bespoke/bake/error_points.h"
#include "bespoke/certificate/inverse.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/mapping/affine_map.h"
#include "bespoke/mapping/composed_map.h"
#include "bespoke/pipeline/detail/bake_steps.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

constexpr std::size_t deviation_points = 100'000;
constexpr std::uint64_t deviation_seed = 77;

// Ψ(1) of an asset.
class WholeMap {
 public:
  explicit WholeMap(const Asset& asset)
      : elastic_(baked_chain(asset.steps)), target_from_source_(asset.target_from_source) {}
  Points operator()(const Points& x) const { return target_from_source_ * elastic_(x); }
  const ElasticChain& elastic() const { return elastic_; }

 private:
  ElasticChain elastic_;
  RigidTransform target_from_source_;
};

Points band_points(const Pyramid& pyramid) {
  if (pyramid.levels.empty()) return Points(3, 0);
  const PyramidLevel& level = pyramid.levels.front();
  return random_points({pyramid.origin, level.voxel_size}, level.leaves, deviation_points, deviation_seed);
}

Statistics distance_statistics(const Points& a, const Points& b) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < a.cols(); ++i) values.push_back((a.col(i) - b.col(i)).norm());
  return summarize(std::move(values));
}

// A step and what its bake found.
struct DerivedStep {
  MapStep step;
  BakeSummary bake;
};

DerivedStep bake_step(const ElasticMap& exact, const BakeOptions& options, const Progress& progress) {
  Bake baked = bake(exact, options, progress);
  return {{exact.affine(), std::move(baked.pyramid), std::move(baked.certificate)}, std::move(baked.summary)};
}

void take_steps(DerivedMap& derived, std::vector<DerivedStep> steps, double tolerance) {
  derived.asset.steps.clear();
  for (std::size_t k = 0; k < steps.size(); ++k) {
    derived.asset.steps.push_back(std::move(steps[k].step));
    if (k == 0)
      derived.bake = std::move(steps[k].bake);
    else
      add_step(steps[k].bake, derived.bake);
  }
  derived.asset.record.tolerance = tolerance;
  derived.asset.record.bake_error = derived.bake.error;
}

// Previews shape nothing that is proved, so one that shows no surface is no reason to refuse.
const TriangleMesh* usable(const TriangleMesh& surface) {
  return surface.faces.cols() > 0 && surface.vertices.allFinite() ? &surface : nullptr;
}

// The source as an asset's previews show it, where a map takes it.
template <class Map>
TriangleMesh previewed_source(const Asset& asset, const Map& map) {
  TriangleMesh surface = source_surface(asset);
  surface.vertices = map(surface.vertices);
  return surface;
}

// How many times as large a map makes its source.
double source_growth(const Asset& asset) {
  const TriangleMesh surface = source_surface(asset);
  return growth(surface, WholeMap(asset)(surface.vertices));
}

// Of several steps each is baked to its share of the tolerance, since errors add up and grow with what comes
// after, and those that need less than their share of the leaves leave it to those after them. surface: where
// the model is before the first.
std::vector<DerivedStep> bake_in_turn(const std::vector<std::shared_ptr<const ElasticMap>>& exact,
                                      TriangleMesh surface, const BakeOptions& options,
                                      const Progress& progress) {
  std::vector<DerivedStep> steps;
  BakeOptions share = options;
  share.surface = usable(surface);
  double growth_after = 1;
  for (const auto& map : exact) growth_after *= size_ratio(map->affine());
  std::size_t used = 0;
  for (const auto& map : exact) {
    growth_after /= size_ratio(map->affine());
    share.tolerance =
        options.tolerance / (power_of_two_scale(growth_after) * static_cast<double>(exact.size()));
    if (options.max_leaves)
      share.max_leaves =
          (*options.max_leaves - std::min(*options.max_leaves, used)) / (exact.size() - steps.size());
    steps.push_back(bake_step(*map, share, progress));
    used += steps.back().step.pyramid.leaf_count();
    surface.vertices = (*map)(surface.vertices);
  }
  return steps;
}

// The error of a chain is that of the whole, not of its first step.
void take_measured_error(DerivedMap& derived) {
  if (derived.asset.steps.size() == 1) return;
  derived.bake.error = derived.asset.record.bake_error = derived.deviation;
  derived.bake.error_random_points = derived.deviation.count;
  derived.bake.error_surface_points = 0;
  derived.bake.tolerance_met = derived.deviation.max <= derived.asset.record.tolerance;
}

// Of the maps that this one is made of, and how it was baked.
std::string recorded_options(Json json, const BakeOptions& options) {
  json["tolerance"] = options.tolerance;
  if (options.max_leaves) json["max_voxels"] = *options.max_leaves * leaf_nodes;
  if (options.precision == ValuePrecision::half) json["half"] = true;
  json["nodes"] = name_of(node_values, options.nodes);
  return json.dump();
}

void record_stages(DerivedMap& derived, const char* name) {
  Json stage = {{"name", "bake"}};
  stage.update(to_json(derived.bake));
  derived.asset.record.stages_json =
      Json::array({std::move(stage), {{"name", name}, {"deviation", to_json(derived.deviation)}}}).dump();
}

}  // namespace

DerivedTolerance tolerance_of_inverse(const Asset& b_from_a) {
  const double size_scale = power_of_two_scale(1 / source_growth(b_from_a));
  return {size_scale * b_from_a.record.target.box.diagonal().norm(), size_scale * b_from_a.record.tolerance};
}

DerivedTolerance tolerance_of_composed(const Asset& b_from_a, const Asset& c_from_b) {
  const double first = source_growth(b_from_a), second = source_growth(c_from_b);
  return {power_of_two_scale(first * second) * b_from_a.record.source.box.diagonal().norm(),
          std::max(power_of_two_scale(second) * b_from_a.record.tolerance, c_from_b.record.tolerance)};
}

BakeOptions derived_bake(const std::optional<Length>& tolerance, const DerivedTolerance& lengths,
                         ValuePrecision precision) {
  BakeOptions options;
  options.tolerance = tolerance ? tolerance->in_mesh_units(lengths.diagonal) : lengths.otherwise;
  // Who names a tolerance wants that one.
  if (!tolerance) options.max_leaves = default_max_leaves;
  options.precision = precision;
  return options;
}

DerivedMap invert_map(const Asset& b_from_a, const BakeOptions& options, const Progress& progress) {
  const Certificate certificate = whole_certificate(b_from_a);
  if (!certificate.is_bijection())
    throw InvalidInput("the map is not certified as a bijection (" +
                       std::to_string(certificate.folded + certificate.undecided) +
                       " cells fold or are undecided), so it has no inverse");
  const WholeMap forth(b_from_a);
  DerivedMap derived;
  Asset& asset = derived.asset;
  asset.target_from_source = inverse(b_from_a.target_from_source);
  asset.path = b_from_a.path;
  asset.record = b_from_a.record;
  std::swap(asset.record.source, asset.record.target);
  asset.record.elastic_method = "inverse of " + b_from_a.record.elastic_method;
  asset.record.options_json =
      recorded_options({{"inverse_of", Json::parse(b_from_a.record.options_json)}}, options);
  // E⁻¹ is the steps' inverses, the last one first.
  std::vector<std::shared_ptr<const ElasticMap>> inverses;
  for (auto step = forth.elastic().steps().rbegin(); step != forth.elastic().steps().rend(); ++step)
    inverses.push_back(
        std::make_shared<InverseMap>(dynamic_cast<const BakedMap&>(**step), b_from_a.target_from_source));
  take_steps(derived, bake_in_turn(inverses, previewed_source(b_from_a, forth), options, progress),
             options.tolerance);
  const WholeMap back(asset);
  for (AnchorRecord& anchor : asset.record.anchors) {
    std::swap(anchor.a, anchor.b);
    anchor.residual = (back(anchor.a) - Points(anchor.b)).norm();
  }
  const Points x = band_points(b_from_a.steps.front().pyramid);
  derived.deviation = distance_statistics(back(forth(x)), x);
  take_measured_error(derived);
  record_stages(derived, "round trip");
  asset = with_preview_of(std::move(asset), b_from_a, [&](const Points& y) { return back(y); });
  asset = with_model_distances_of(std::move(asset), b_from_a, b_from_a, true);
  return derived;
}

namespace {

// Both as one step; empty where that would fold, or cost more than it saves: more than twice the voxels of
// both, too much memory, or regions in which the tolerance is given up.
std::optional<DerivedStep> merged_step(const Asset& first, const Asset& second, const BakeOptions& options,
                                       const Progress& progress) {
  const WholeMap b_from_a(first), c_from_b(second);
  const ComposedMap both(*b_from_a.elastic().steps().front(), first.target_from_source,
                         *c_from_b.elastic().steps().front());
  const TriangleMesh surface = source_surface(first);
  BakeOptions bake_options = options;
  bake_options.surface = usable(surface);
  try {
    DerivedStep merged = bake_step(both, bake_options, progress);
    // One look-up instead of two, and nearly always fewer voxels; twice as many are no saving.
    constexpr std::size_t worth = 2;
    const bool folds = !merged.step.certificate.is_bijection() && whole_certificate(first).is_bijection() &&
                       whole_certificate(second).is_bijection();
    if (!folds && merged.bake.relaxed.empty() &&
        merged.step.pyramid.voxel_count() <= worth * (voxel_count(first) + voxel_count(second)))
      return merged;
  } catch (const MemoryLimitError&) {
    // As two steps it may fit.
  }
  return std::nullopt;
}

// a→b's steps as they are, then b→c's, each seen from the frame of a.
std::vector<DerivedStep> joined_steps(const Asset& first, const Asset& second, const BakeOptions& options,
                                      const Progress& progress) {
  std::vector<DerivedStep> steps;
  for (const MapStep& step : first.steps) steps.push_back({step, {}});
  steps.front().bake.error = first.record.bake_error;
  const BakedMap at_rest({}, {});
  const ElasticChain downstream_map = baked_chain(second.steps);
  std::vector<std::shared_ptr<const ElasticMap>> moved;
  for (const auto& step : downstream_map.steps())
    moved.push_back(std::make_shared<ComposedMap>(at_rest, first.target_from_source, *step));
  const ElasticChain before = baked_chain(first.steps);
  for (DerivedStep& step : bake_in_turn(moved, previewed_source(first, before), options, progress))
    steps.push_back(std::move(step));
  return steps;
}

std::vector<DerivedStep> composed_steps(const Asset& first, const Asset& second, const BakeOptions& options,
                                        const Progress& progress) {
  if (first.steps.size() == 1 && second.steps.size() == 1) {
    std::optional<DerivedStep> merged = merged_step(first, second, options, progress);
    if (merged) {
      std::vector<DerivedStep> steps;
      steps.push_back(std::move(*merged));
      return steps;
    }
  }
  return joined_steps(first, second, options, progress);
}

}  // namespace

DerivedMap compose_maps(const Asset& b_from_a, const Asset& c_from_b, const BakeOptions& options,
                        MeetingModels meeting, const Progress& progress) {
  if (meeting == MeetingModels::must_be_the_same &&
      b_from_a.record.target.hash != c_from_b.record.source.hash)
    throw InvalidInput("the first map leads to another model (" + b_from_a.record.target.hash.substr(0, 12) +
                       "…) than the second starts from (" + c_from_b.record.source.hash.substr(0, 12) +
                       "…); --any-models joins them all the same");
  const WholeMap first(b_from_a), second(c_from_b);
  DerivedMap derived;
  Asset& asset = derived.asset;
  asset.target_from_source = c_from_b.target_from_source * b_from_a.target_from_source;
  asset.path = b_from_a.path;
  asset.record = b_from_a.record;
  asset.record.target = c_from_b.record.target;
  asset.record.lambda = std::max(b_from_a.record.lambda, c_from_b.record.lambda);
  asset.record.elastic_method = c_from_b.record.elastic_method + " after " + b_from_a.record.elastic_method;
  asset.record.surface_fit_method =
      c_from_b.record.surface_fit_method + " after " + b_from_a.record.surface_fit_method;
  asset.record.anchors.clear();  // pairs of a and b, or of b and c: none of them joins a and c
  asset.record.options_json = recorded_options({{"first", Json::parse(b_from_a.record.options_json)},
                                                {"second", Json::parse(c_from_b.record.options_json)}},
                                               options);
  take_steps(derived, composed_steps(b_from_a, c_from_b, options, progress), options.tolerance);
  if (asset.steps.size() > 1) asset.path = RotationPath::flow;
  const Points x = band_points(asset.steps.front().pyramid);
  derived.deviation = distance_statistics(WholeMap(asset)(x), second(first(x)));
  take_measured_error(derived);
  record_stages(derived, "composition");
  asset = with_preview_of(std::move(asset), b_from_a);
  asset = with_model_distances_of(std::move(asset), b_from_a, c_from_b, false);
  return derived;
}

}  // namespace bespoke
