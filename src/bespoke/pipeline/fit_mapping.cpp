#include "bespoke/pipeline/fit_mapping.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "bespoke/alignment/align_models.h"
#include "bespoke/anchors/anchor_audit.h"
#include "bespoke/anchors/contradicting_anchors.h"
#include "bespoke/elastic/csrbf.h"
#include "bespoke/elastic/multiscale.h"
#include "bespoke/elastic/pffd.h"
#include "bespoke/error.h"
#include "bespoke/rbf/global_rbf.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const Statistics& statistics) {
  return {{"count", statistics.count}, {"min", statistics.min}, {"median", statistics.median},
          {"p95", statistics.p95},     {"p99", statistics.p99}, {"max", statistics.max}};
}

std::vector<double> distances(const Points& from, const Points& to) {
  const Eigen::VectorXd lengths = (from - to).colwise().norm();
  return {lengths.begin(), lengths.end()};
}

double rotation_degrees(const RigidTransform& transform) {
  return Eigen::AngleAxisd(transform.rotation).angle() * 180 / std::numbers::pi;
}

StageReport rigid_report(const RigidTransform& target_from_source, const Statistics& residual,
                         const char* what, const Stopwatch& watch) {
  char line[300];
  std::snprintf(line, sizeof line, "%zu %s, turned by %.4g degrees, residual p95 %.4g max %.4g",
                residual.count, what, rotation_degrees(target_from_source), residual.p95, residual.max);
  const Json json = {{"pairs_of", what},
                     {"pairs", residual.count},
                     {"rotation_degrees", rotation_degrees(target_from_source)},
                     {"residual", to_json(residual)}};
  return {"rigid", line, json.dump(), watch.seconds()};
}

StageReport coarse_report(const Statistics& residual, const Anchors& anchors, const Stopwatch& watch) {
  char text[200];
  std::snprintf(text, sizeof text, "%zu anchors, residual p95 %.4g max %.4g", residual.count, residual.p95,
                residual.max);
  const AnchorAudit audit = audit_anchors(anchors);
  std::string line = text;
  if (!audit.suspicious.empty()) line += "; suspicious: " + to_string(audit, anchors);
  Json suspicious = Json::array();
  for (const SuspiciousAnchor& anchor : audit.suspicious) {
    Json entry = {{"index", anchor.index}, {"name", anchor.name}, {"distance", anchor.distance}};
    if (anchor.swapped_with) entry["swapped_with"] = *anchor.swapped_with;
    suspicious.push_back(std::move(entry));
  }
  Json contradicting = Json::array();
  for (const ContradictingAnchors& pair : contradicting_anchors(anchors))
    contradicting.push_back({{"indices", {pair.first, pair.second}},
                             {"names", {anchors.pairs[pair.first].name, anchors.pairs[pair.second].name}},
                             {"apart", pair.apart},
                             {"asked", pair.asked}});
  const Json json = {{"pairs", residual.count},
                     {"residual", to_json(residual)},
                     {"suspicious_anchors", suspicious},
                     {"contradicting_anchors", contradicting}};
  return {"coarse", line, json.dump(), watch.seconds()};
}

StageReport surface_fit_report(const SurfaceFitSummary& summary, SurfaceFitMethod method) {
  const std::string name(entry_of(method).name);
  const Json json = {{"method", name},
                     {"before", to_json(summary.before)},
                     {"after", to_json(summary.after)},
                     {"iterations", summary.iterations},
                     {"stop_reason", to_string(summary.stop_reason)},
                     {"unmatched_vertices", summary.unmatched_vertices},
                     {"off_surface_anchors", summary.off_surface_anchors},
                     {"stiffness", summary.stiffness},
                     {"similarity_suffices", summary.similarity_suffices},
                     {"matched_boundaries", summary.matched_boundaries},
                     {"mended_vertices", summary.mended_vertices}};
  return {"surface-fit", name + ": " + to_string(summary), json.dump(), summary.seconds};
}

// ---- what the elastic map is fitted to

/// Every distinct place that a face of the source uses, and where it goes.
struct PlacePairs {
  Points sources;                ///< 3×k
  Points targets;                ///< 3×k; the mean where several vertices share the place
  std::vector<int> referenced;   ///< vertices in some face
  std::size_t unreferenced = 0;  ///< vertices in none
  std::size_t duplicates = 0;    ///< vertices at the place of an earlier one
};

PlacePairs place_pairs(const TriangleMesh& source, const Points& fitted) {
  PlacePairs pairs;
  std::vector<char> used(static_cast<std::size_t>(source.vertices.cols()), 0);
  for (Eigen::Index i = 0; i < source.faces.size(); ++i) used[static_cast<std::size_t>(source.faces(i))] = 1;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) pairs.referenced.push_back(static_cast<int>(i));
  pairs.unreferenced = used.size() - pairs.referenced.size();

  std::vector<int> order = pairs.referenced;
  const auto place = [&](int vertex) { return source.vertices.col(vertex); };
  const auto before = [&](int i, int j) {
    return std::lexicographical_compare(place(i).begin(), place(i).end(), place(j).begin(), place(j).end());
  };
  std::stable_sort(order.begin(), order.end(), before);
  std::vector<std::pair<int, Vector3>> places;  // first vertex and mean of the fitted positions
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    Vector3 sum = Vector3::Zero();
    while (end < order.size() && !before(order[begin], order[end])) sum += fitted.col(order[end++]);
    places.emplace_back(order[begin], sum / static_cast<double>(end - begin));
    pairs.duplicates += end - begin - 1;
  }
  // The vertices' own order, which is usually the more coherent one.
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  pairs.sources.resize(3, static_cast<Eigen::Index>(places.size()));
  pairs.targets.resize(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    pairs.sources.col(static_cast<Eigen::Index>(i)) = place(places[i].first);
    pairs.targets.col(static_cast<Eigen::Index>(i)) = places[i].second;
  }
  return pairs;
}

// ---- elastic map

struct ElasticFit {
  std::shared_ptr<const ElasticMap> map;
  std::string line;
  Json json;
};

ElasticFit fit_elastic_csrbf(const PlacePairs& pairs, const FitOptions& options, const Progress& progress) {
  CsrbfOptions csrbf;
  csrbf.lambda = options.lambda;
  csrbf.max_memory = options.max_memory;
  CsrbfFit fit = fit_csrbf(pairs.sources, pairs.targets, csrbf, progress);
  const CsrbfEstimate& estimate = fit.summary.estimate;
  return {std::move(fit.map),
          to_string(fit.summary),
          {{"method", "csrbf"},
           {"centers", estimate.centers},
           {"entries_per_row", estimate.entries_per_row},
           {"factor_entries", estimate.factor_entries},
           {"condition_estimate", estimate.condition},
           {"center_residual_max", fit.summary.residual}}};
}

ElasticFit fit_elastic_multiscale(const PlacePairs& pairs, const FitOptions& options,
                                  const Progress& progress) {
  MultiscaleOptions multiscale;
  multiscale.lambda = options.lambda;
  multiscale.tolerance = options.fit_tolerance;
  multiscale.composed = options.elastic == ElasticMethod::diffeomorphic;
  MultiscaleFit fit = fit_multiscale(pairs.sources, pairs.targets, multiscale, progress);
  const char* method = multiscale.composed ? "diffeomorphic" : "multiscale";
  return {std::move(fit.map),
          std::string(method) + ": " + to_string(fit.summary),
          {{"method", method},
           {"lambdas", fit.summary.lambdas},
           {"centers", fit.summary.centers},
           {"gradient_bounds", fit.summary.gradient_bounds},
           {"within_tolerance", fit.summary.within_tolerance}}};
}

ElasticFit fit_elastic_pffd(const TriangleMesh& source, const Points& fitted, const FitOptions& options) {
  auto map = std::make_shared<const PffdMap>(source, fitted, options.lambda);
  return {std::move(map), "pffd: " + std::to_string(source.faces.cols()) + " faces", {{"method", "pffd"}}};
}

ElasticFit fit_elastic(const TriangleMesh& source, const Points& fitted, const PlacePairs& pairs,
                       const FitOptions& options, const Progress& progress) {
  switch (options.elastic) {
    case ElasticMethod::csrbf:
      return fit_elastic_csrbf(pairs, options, progress);
    case ElasticMethod::multiscale:
    case ElasticMethod::diffeomorphic:
      return fit_elastic_multiscale(pairs, options, progress);
    case ElasticMethod::pffd:
      return fit_elastic_pffd(source, fitted, options);
  }
  throw InvalidInput("unknown elastic method");
}

/// Runs the elastic stage and fills what can be said only at the end.
void finish(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
            const FitOptions& options, const Progress& progress) {
  const Stopwatch watch;
  progress.step("elastic", 0, 0);
  const PlacePairs pairs = place_pairs(source, result.fitted_vertices);
  ElasticFit fit = fit_elastic(source, result.fitted_vertices, pairs, options, progress);
  result.elastic = std::move(fit.map);

  const ElasticMap& elastic = *result.elastic;
  const Points images = elastic(source.vertices);
  result.vertex_residuals = summarize(
      distances(images(Eigen::all, pairs.referenced), result.fitted_vertices(Eigen::all, pairs.referenced)));
  if (options.fit_tolerance > 0)
    result.unmet = unmet_vertices(source, images, result.fitted_vertices, options.fit_tolerance);
  result.anchor_residual =
      distances(result.target_from_source * elastic(source_points(anchors)), target_points(anchors));
  result.anchor_residuals = summarize(result.anchor_residual);

  char line[300];
  std::snprintf(line, sizeof line, "; vertices p95 %.4g max %.4g, anchors max %.4g off",
                result.vertex_residuals.p95, result.vertex_residuals.max, result.anchor_residuals.max);
  fit.line += line;
  if (!result.unmet.empty()) fit.line += "; " + to_string(result.unmet);
  if (pairs.unreferenced > 0)
    fit.line += "; " + std::to_string(pairs.unreferenced) + " unreferenced vertices left out";
  if (pairs.duplicates > 0)
    fit.line += "; " + std::to_string(pairs.duplicates) + " duplicate vertices merged";
  Json json = std::move(fit.json);
  json.update({{"lambda", options.lambda},
               {"vertex_residual", to_json(result.vertex_residuals)},
               {"unmet_vertices", result.unmet.size()},
               {"anchor_residual", to_json(result.anchor_residuals)},
               {"unreferenced_vertices", pairs.unreferenced},
               {"duplicate_vertices", pairs.duplicates}});
  result.stages.push_back({"elastic", fit.line, json.dump(), watch.seconds()});
}

void require_usable(const TriangleMesh& source, const Anchors& anchors, const FitOptions& options) {
  require_valid(source, "source");
  if (!(options.lambda > 0 && std::isfinite(options.lambda)))
    throw InvalidInput("lambda is " + std::to_string(options.lambda) + ", but must be finite and above 0");
  for (const AnchorPair& pair : anchors.pairs)
    if (!(pair.a.allFinite() && pair.b.allFinite() && pair.weight > 0))
      throw InvalidInput("anchor \"" + pair.name + "\" is not finite, or its weight is not above 0");
}

StageReport alignment_report(const Alignment& alignment) {
  Json json = {{"anchors", "none"},
               {"scale", alignment.target_from_source.scale},
               {"confidence", alignment.confidence()},
               {"misfit", alignment.misfit},
               {"residual", alignment.residual},
               {"bending", alignment.bending},
               {"matched", alignment.matched},
               {"departure", alignment.departure},
               {"asymmetry", alignment.asymmetry},
               {"same_boundaries", alignment.same_boundaries}};
  if (alignment.next_misfit) json["next_misfit"] = *alignment.next_misfit;
  if (alignment.mirror_misfit) json["mirror_misfit"] = *alignment.mirror_misfit;
  return {"alignment", "without anchors: " + to_string(alignment), json.dump(), alignment.seconds};
}

/// The two surfaces alone give the rigid part and the start of the surface fitting.
FittedMapping fit_without_anchors(const TriangleMesh& source, const TriangleMesh& target,
                                  const FitOptions& options, const Progress& progress) {
  // Of the diagonal. Below it closest points from the similarity find their way; starting from the coarse
  // deformation instead costs the bodies a fifth of their accuracy, and quarters the error of curled fingers.
  constexpr double most_departure = 0.02;
  const Alignment alignment = align_models(source, target, progress);
  require_certain(alignment);
  FittedMapping result;
  result.stages.push_back(alignment_report(alignment));

  const Stopwatch rigid_watch;
  result.target_from_source =
      align_rigidly(source.vertices, alignment.deformed, Eigen::VectorXd::Ones(source.vertices.cols()));
  const RigidTransform source_from_target = inverse(result.target_from_source);
  const Points deformed = source_from_target * alignment.deformed;
  result.stages.push_back(rigid_report(
      result.target_from_source, summarize(distances(source.vertices, deformed)), "vertices", rigid_watch));

  const bool departs = alignment.departure > most_departure;
  const TriangleMesh start =
      departs
          ? TriangleMesh{deformed, source.faces}
          : TriangleMesh{source_from_target * (alignment.target_from_source * source.vertices), source.faces};
  SurfaceFitOptions surface_fit = options.surface_fit;
  if (surface_fit.boundaries == BoundaryRule::automatic)
    surface_fit.boundaries = alignment.same_boundaries ? BoundaryRule::matched : BoundaryRule::free;
  const TriangleMesh target_in_source{source_from_target * target.vertices, target.faces};
  const Points none(3, 0);
  SurfaceFit fit = fit_surface({start, start.vertices, target_in_source, none, none, Eigen::VectorXd()},
                               surface_fit, progress);
  result.fitted_vertices = std::move(fit.vertices);
  result.confidence = std::move(fit.confidence);
  result.stages.push_back(surface_fit_report(fit.summary, options.surface_fit.method));
  finish(result, source, {}, options, progress);
  return result;
}

}  // namespace

FittedMapping fit_mapping(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                          const FitOptions& options, const Progress& progress) {
  require_usable(source, anchors, options);
  require_valid(target, "target");
  if (anchors.pairs.empty()) return fit_without_anchors(source, target, options, progress);
  FittedMapping result;
  const Points anchor_sources = source_points(anchors);
  const Eigen::VectorXd anchor_weights = weights(anchors);

  const Stopwatch rigid_watch;
  progress.step("rigid", 0, 0);
  result.target_from_source = align_rigidly(anchor_sources, target_points(anchors), anchor_weights);
  const RigidTransform source_from_target = inverse(result.target_from_source);
  const Points anchor_targets = source_from_target * target_points(anchors);
  result.stages.push_back(rigid_report(result.target_from_source,
                                       summarize(distances(anchor_sources, anchor_targets)), "anchors",
                                       rigid_watch));

  const Stopwatch coarse_watch;
  progress.step("coarse", 0, 0);
  const GlobalRbf coarse(anchor_sources, anchor_targets, anchor_weights);
  const Points warped = coarse(source.vertices);
  result.stages.push_back(
      coarse_report(summarize(distances(coarse(anchor_sources), anchor_targets)), anchors, coarse_watch));

  const TriangleMesh target_in_source{source_from_target * target.vertices, target.faces};
  SurfaceFit fit =
      fit_surface({source, warped, target_in_source, anchor_sources, anchor_targets, anchor_weights},
                  options.surface_fit, progress);
  result.fitted_vertices = std::move(fit.vertices);
  result.confidence = std::move(fit.confidence);
  result.stages.push_back(surface_fit_report(fit.summary, options.surface_fit.method));

  finish(result, source, anchors, options, progress);
  return result;
}

FittedMapping fit_mapping_to_fitted(const TriangleMesh& source, const TriangleMesh& fitted,
                                    const Anchors& anchors, const FitOptions& options,
                                    const Progress& progress) {
  require_usable(source, anchors, options);
  require_valid(fitted, "fitted source");
  if (fitted.vertices.cols() != source.vertices.cols() || fitted.faces.cols() != source.faces.cols())
    throw InvalidInput("the fitted mesh has " + std::to_string(fitted.vertices.cols()) + " vertices and " +
                       std::to_string(fitted.faces.cols()) + " faces, but the source has " +
                       std::to_string(source.vertices.cols()) + " and " +
                       std::to_string(source.faces.cols()) + "; both must have the same connectivity");
  for (Eigen::Index face = 0; face < source.faces.cols(); ++face)
    if (source.faces.col(face) != fitted.faces.col(face))
      throw InvalidInput("face " + std::to_string(face) +
                         " of the fitted mesh has other vertices than the source's; both must have the "
                         "same connectivity");
  FittedMapping result;

  const Stopwatch rigid_watch;
  progress.step("rigid", 0, 0);
  const bool by_anchors = !anchors.pairs.empty();
  const std::vector<int> used = place_pairs(source, fitted.vertices).referenced;
  const Points rigid_sources =
      by_anchors ? source_points(anchors) : Points(source.vertices(Eigen::all, used));
  const Points rigid_targets =
      by_anchors ? target_points(anchors) : Points(fitted.vertices(Eigen::all, used));
  const Eigen::VectorXd rigid_weights =
      by_anchors ? weights(anchors) : Eigen::VectorXd::Ones(rigid_sources.cols());
  result.target_from_source = align_rigidly(rigid_sources, rigid_targets, rigid_weights);
  const Statistics residual = summarize(distances(result.target_from_source * rigid_sources, rigid_targets));
  result.stages.push_back(
      rigid_report(result.target_from_source, residual, by_anchors ? "anchors" : "vertices", rigid_watch));

  result.fitted_vertices = inverse(result.target_from_source) * fitted.vertices;
  const Json given = {{"method", "given"}};
  result.stages.push_back({"surface-fit", "given: the fitted mesh as it is", given.dump(), 0});

  finish(result, source, anchors, options, progress);
  return result;
}

}  // namespace bespoke
