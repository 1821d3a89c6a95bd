#include "bespoke/pipeline/derive_map.h"

#include <utility>

#include "bespoke/bake/error_points.h"
#include "bespoke/certificate/inverse.h"
#include "bespoke/error.h"
#include "bespoke/mapping/composed_map.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

constexpr std::size_t deviation_points = 100'000;
constexpr std::uint64_t deviation_seed = 77;

// Ψ(1) of an asset.
class WholeMap {
 public:
  explicit WholeMap(const Asset& asset)
      : elastic_(asset.affine, asset.pyramid), target_from_source_(asset.target_from_source) {}
  Points operator()(const Points& x) const { return target_from_source_ * elastic_(x); }
  const BakedMap& elastic() const { return elastic_; }

 private:
  BakedMap elastic_;
  RigidTransform target_from_source_;
};

Points band_points(const Pyramid& pyramid) {
  if (pyramid.levels.empty()) return Points(3, 0);
  const PyramidLevel& level = pyramid.levels.front();
  return random_points({pyramid.origin, level.voxel_size}, level.leaves, deviation_points, deviation_seed);
}

Statistics distances(const Points& a, const Points& b) {
  std::vector<double> values;
  for (Eigen::Index i = 0; i < a.cols(); ++i) values.push_back((a.col(i) - b.col(i)).norm());
  return summarize(std::move(values));
}

void bake_into(DerivedMap& derived, const ElasticMap& exact, const BakeOptions& options,
               const Progress& progress) {
  Bake baked = bake(exact, options, progress);
  derived.bake = std::move(baked.summary);
  derived.asset.affine = exact.affine();
  derived.asset.pyramid = std::move(baked.pyramid);
  derived.asset.certificate = certify(derived.asset.pyramid, derived.asset.affine, 1, progress);
  derived.asset.record.tolerance = options.tolerance;
  derived.asset.record.bake_error = derived.bake.error;
}

void record_stages(DerivedMap& derived, const char* name) {
  Json stage = {{"name", "bake"}};
  stage.update(to_json(derived.bake));
  derived.asset.record.stages_json =
      Json::array({std::move(stage), {{"name", name}, {"deviation", to_json(derived.deviation)}}}).dump();
}

}  // namespace

DerivedMap invert_map(const Asset& b_from_a, const BakeOptions& options, const Progress& progress) {
  if (!b_from_a.certificate.is_bijection())
    throw InvalidInput("the map is not certified as a bijection (" +
                       std::to_string(b_from_a.certificate.folded + b_from_a.certificate.undecided) +
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
      Json({{"inverse_of", Json::parse(b_from_a.record.options_json)}, {"tolerance", options.tolerance}})
          .dump();
  bake_into(derived, InverseMap(forth.elastic(), b_from_a.target_from_source), options, progress);
  const WholeMap back(asset);
  for (AnchorRecord& anchor : asset.record.anchors) {
    std::swap(anchor.a, anchor.b);
    anchor.residual = (back(anchor.a) - Points(anchor.b)).norm();
  }
  const Points x = band_points(b_from_a.pyramid);
  derived.deviation = distances(back(forth(x)), x);
  record_stages(derived, "round trip");
  asset = with_preview_of(std::move(asset), b_from_a, [&](const Points& y) { return back(y); });
  return derived;
}

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
  asset.record.elastic_method = c_from_b.record.elastic_method + " after " + b_from_a.record.elastic_method;
  asset.record.surface_fit_method =
      c_from_b.record.surface_fit_method + " after " + b_from_a.record.surface_fit_method;
  asset.record.anchors.clear();  // pairs of a and b, or of b and c: none of them joins a and c
  asset.record.options_json = Json({{"first", Json::parse(b_from_a.record.options_json)},
                                    {"second", Json::parse(c_from_b.record.options_json)},
                                    {"tolerance", options.tolerance}})
                                  .dump();
  bake_into(derived, ComposedMap(first.elastic(), b_from_a.target_from_source, second.elastic()), options,
            progress);
  const Points x = band_points(asset.pyramid);
  derived.deviation = distances(WholeMap(asset)(x), second(first(x)));
  record_stages(derived, "composition");
  asset = with_preview_of(std::move(asset), b_from_a);
  return derived;
}

}  // namespace bespoke
