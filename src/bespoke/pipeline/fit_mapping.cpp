#include "bespoke/pipeline/fit_mapping.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/anchors/patch_borders.h"
#include "bespoke/digits.h"
#include "bespoke/error.h"
#include "bespoke/mesh/seams.h"
#include "bespoke/pipeline/elastic_pairs.h"
#include "bespoke/pipeline/lay_source.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

void require_usable(const TriangleMesh& source, const Anchors& anchors, const FitOptions& options) {
  require_valid(source, "source");
  if (!(options.lambda > 0 && std::isfinite(options.lambda)))
    throw InvalidInput("lambda is " + std::to_string(options.lambda) + ", but must be finite and above 0");
  if (options.steps && *options.steps < 1)
    throw InvalidInput("a map of " + std::to_string(*options.steps) + " steps; there must be one at least");
  for (const AnchorPair& pair : anchors.pairs)
    if (!(pair.a.allFinite() && pair.b.allFinite() && pair.weight > 0 && pair.sigma.value_or(0) >= 0))
      throw InvalidInput("anchor \"" + pair.name +
                         "\" is not finite, its weight is not above 0, or its sigma below 0");
}

/// Files of meshes name no unit. Beyond this factor the models are in two: a doll is a sixth of a person, a
/// centimetre a tenth of a decimetre.
constexpr double largest_size_ratio = 8;

/// source and target: places that correspond, or all of either model.
void require_one_unit(const Points& source, const Points& target, const std::string& what) {
  const double a = diagonal(source), b = diagonal(target);
  if (std::max(a, b) <= largest_size_ratio * std::min(a, b)) return;
  if (!(a > 0 && b > 0)) return;  // what is wrong with these is told where they are used
  throw InvalidInput("the target is " + in_digits(b / a, 3) + " times as large as the source by " + what +
                     ", as if they were in two units; bring one of them, and its anchors, to the unit of the "
                     "other");
}

void require_same_connectivity(const TriangleMesh& source, const TriangleMesh& fitted) {
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
}

/// What the elastic map is fitted to, with the anchors that the surface does not carry.
ElasticPairs pairs_for_elastic(const FittedMapping& fitted, const TriangleMesh& source,
                               const Anchors& anchors, const FitOptions& options, ElasticSummary& summary) {
  // A vertex and an anchor closer than this ask an interpolating map for differences of rounding errors.
  constexpr double least_distance = 1e-6;  // of the source's diagonal
  const double off_surface = std::max(options.fit_tolerance, least_distance * diagonal(source.vertices));
  const std::vector<std::size_t> off = anchors_off_surface(source, anchors, off_surface);
  ElasticPairs pairs = elastic_pairs(source, fitted.fitted_vertices);
  summary.unreferenced_vertices = pairs.unreferenced;
  summary.duplicate_vertices = pairs.duplicates;
  summary.anchors_off_surface = off.size();
  summary.meets_anchors_off_surface = elastic_method(options.elastic).meets_points;
  if (off.empty() || !summary.meets_anchors_off_surface) return pairs;
  return with_anchors(std::move(pairs), anchors, off, inverse(fitted.target_from_source));
}

std::vector<double> anchor_residuals(const FittedMapping& fitted, const Anchors& anchors) {
  return distances(fitted.target_from_source * (*fitted.elastic)(source_points(anchors)),
                   target_points(anchors));
}

/// What can be said only with the whole map at hand.
void judge(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
           const FitOptions& options) {
  ElasticSummary& summary = result.summary.elastic;
  const ElasticMap& elastic = *result.elastic;
  const std::vector<int>& referenced = result.pairs.referenced;
  const Points images = elastic(source.vertices);
  summary.vertex_residuals =
      summarize(distances(images(Eigen::all, referenced), result.fitted_vertices(Eigen::all, referenced)));
  if (options.fit_tolerance > 0)
    summary.unmet = unmet_vertices(
        source, images, result.fitted_vertices, options.fit_tolerance,
        result.summary.contact ? result.summary.contact->released : std::vector<ReleasedVertex>{});
  result.anchor_residual = anchor_residuals(result, anchors);
  summary.anchor_residuals = summarize(result.anchor_residual);
}

ElasticOptions elastic_options(const FitOptions& options) {
  return {options.lambda, options.fit_tolerance, options.max_memory};
}

void take_steps(FittedMapping& result, ElasticSteps steps) {
  ElasticSummary& summary = result.summary.elastic;
  summary.found = std::move(steps.found.front());
  summary.later_steps.assign(std::make_move_iterator(steps.found.begin() + 1),
                             std::make_move_iterator(steps.found.end()));
  result.step_sources = std::move(steps.sources);
  result.elastic = std::make_shared<const ElasticChain>(std::move(steps.maps));
}

/// Where the target touches itself no homeomorphism exists: the parts of the fitted source are held apart.
void hold_parts_apart(FittedMapping& result, const TriangleMesh& source, const FitOptions& options,
                      const Progress& progress) {
  // Parts that pass through each other more deeply were not laid there by a target's contact.
  constexpr double reach = 20;  // of the gap
  progress.step("contact", 0, 0);
  ContactFit apart = hold_apart(source, result.fitted_vertices,
                                {.gap = options.contact_gap, .reach = reach * options.contact_gap}, progress);
  if (apart.summary.touching == 0) return;
  result.fitted_vertices = std::move(apart.vertices);
  result.summary.contact = std::move(apart.summary);
}

/// The elastic map as a chain of so many steps along surfaces between the two, or as one.
void fit_steps(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
               const FitOptions& options, int count, const Progress& progress) {
  if (count > 1) {
    result.plan = plan_steps(source, result.fitted_vertices, result.pairs, count);
    // Only the path knows turns beyond half a one.
    const RegionalMotion motion = result.plan->path->motion();
    if (!options.steps) result.plan->times = equal_times(std::max(count, step_count(motion)));
    result.summary.elastic.motion = motion;
    take_steps(result, fit_elastic_steps(source, result.pairs, *result.plan, options.elastic,
                                         elastic_options(options), progress));
  } else {
    ElasticFit fit = elastic_method(options.elastic)
                         .fit({source, result.fitted_vertices, result.pairs.sources, result.pairs.targets},
                              elastic_options(options), progress);
    take_steps(result, {{std::move(fit.map)}, {std::move(fit.found)}, {source.vertices}});
  }
  judge(result, source, anchors, options);
}

/// Parts that slide along each other neither turn nor stretch, but shear the space between them. Layers that
/// do not fold cannot follow where that is too steep: where more than one vertex in a hundred is missed there
/// are twice as many steps, for as long as that helps.
void divide_where_missed(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                         const FitOptions& options, const Progress& progress) {
  constexpr std::size_t most_steps = 32;
  const auto missed = [](const FittedMapping& fit) { return fit.summary.elastic.vertex_residuals.p99; };
  while (missed(result) > options.fit_tolerance && 2 * result.elastic->steps().size() <= most_steps) {
    FittedMapping finer = result;
    fit_steps(finer, source, anchors, options, 2 * static_cast<int>(result.elastic->steps().size()),
              progress);
    if (missed(finer) >= missed(result)) return;
    result = std::move(finer);
    result.summary.elastic.divided_where_missed = true;
  }
}

/// The elastic map of the fitted vertices (IV.D, IV.E): one for models in about the same pose, else a chain
/// of them along surfaces between the two.
void fit_elastic_map(FittedMapping& result, const TriangleMesh& source, const Anchors& anchors,
                     const FitOptions& options, const Progress& progress) {
  const Stopwatch watch;
  progress.step("elastic", 0, 0);
  ElasticSummary& summary = result.summary.elastic;
  result.pairs = pairs_for_elastic(result, source, anchors, options, summary);
  summary.method = options.elastic;
  summary.lambda = options.lambda;
  summary.motion = regional_motion(source, result.fitted_vertices);
  fit_steps(result, source, anchors, options, options.steps.value_or(step_count(summary.motion)), progress);
  const bool follows = elastic_method(options.elastic).keeps_orientation && options.fit_tolerance > 0;
  if (follows && !options.steps) divide_where_missed(result, source, anchors, options, progress);
  summary.seconds = watch.seconds();
}

void require_models(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                    const FitOptions& options) {
  require_usable(source, anchors, options);
  require_valid(target, "target");
  if (anchors.pairs.size() > 2)
    require_one_unit(source_points(anchors), target_points(anchors), "their anchors");
  else
    require_one_unit(source.vertices, target.vertices, "their bounding boxes");
}

/// The models as the surface fitting takes them: along a seam a surface does not end.
struct JoinedModels {
  JoinedMesh source, target;
};

JoinedModels joined_models(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                           const FitOptions& options) {
  const auto join = options.surface_fit.mend_models ? joined_at_seams : left_open;
  JoinedModels joined{join(source), join(target)};
  result.summary.seams = {joined.source.joined(), joined.target.joined()};
  return joined;
}

/// From the vertices of the joined source to those of the source.
void part_at_seams(FittedMapping& result, const JoinedMesh& source) {
  result.fitted_vertices = result.fitted_vertices(Eigen::all, source.of_vertex).eval();
  if (!result.confidence.empty()) {
    std::vector<double> confidence;
    for (const int vertex : source.of_vertex)
      confidence.push_back(result.confidence[static_cast<std::size_t>(vertex)]);
    result.confidence = std::move(confidence);
  }
  const auto renumber = [&](int& vertex) { vertex = source.first[static_cast<std::size_t>(vertex)]; };
  if (std::optional<SurfaceFitSummary>& surface = result.summary.surface)
    for (std::vector<int>* vertices :
         {&surface->cavity_vertices, &surface->excluded_vertices, &surface->stretched_vertices})
      std::for_each(vertices->begin(), vertices->end(), renumber);
  if (result.summary.contact)
    for (ReleasedVertex& released : result.summary.contact->released) renumber(released.vertex);
}

/// Of places along the mapped curve from its counterpart, mesh units.
double largest_distance(const FittedMapping& result, const AnchorCurve& curve) {
  constexpr int places = 1000;
  Points along(3, places);
  for (int i = 0; i < places; ++i) along.col(i) = point_along(curve.a, curve.closed, i / (places - 1.0));
  const Points mapped = result.target_from_source * (*result.elastic)(along);
  return distance_from_polyline(curve.b, curve.closed, mapped);
}

void judge_lines(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                 const Anchors& anchors) {
  for (const AnchorCurve& curve : anchors.curves)
    result.summary.curves.push_back({curve.name, largest_distance(result, curve)});
  for (const PatchBorder& border : patch_borders(anchors, source, target)) {
    std::optional<double>& largest = result.summary.patches[border.patch].largest_distance;
    largest = std::max(largest.value_or(0), largest_distance(result, border.curve));
  }
}

}  // namespace

void divide_step(FittedMapping& fitted, const TriangleMesh& source, const Anchors& anchors,
                 const FitOptions& options, std::size_t step, const Progress& progress) {
  if (step >= fitted.elastic->steps().size()) throw InvalidInput("there is no such step to divide");
  const Stopwatch watch;
  const std::vector<std::shared_ptr<const ElasticMap>>& maps = fitted.elastic->steps();
  if (!fitted.plan) fitted.plan = plan_steps(source, fitted.fitted_vertices, fitted.pairs, 1);
  fitted.plan = halved(*fitted.plan, step);
  ElasticSteps halves = fit_halves(source, fitted.pairs, *fitted.plan, *fitted.elastic, step, options.elastic,
                                   elastic_options(options), progress);
  ElasticSummary& summary = fitted.summary.elastic;
  ElasticSteps steps;
  for (std::size_t k = 0; k < maps.size(); ++k) {
    for (std::size_t half = 0; half < (k == step ? 2 : 0); ++half) {
      steps.maps.push_back(std::move(halves.maps[half]));
      steps.found.push_back(std::move(halves.found[half]));
      steps.sources.push_back(std::move(halves.sources[half]));
    }
    if (k == step) continue;
    steps.maps.push_back(maps[k]);
    steps.found.push_back(k == 0 ? summary.found : summary.later_steps[k - 1]);
    steps.sources.push_back(fitted.step_sources[k]);
  }
  take_steps(fitted, std::move(steps));
  ++summary.divided_steps;
  judge(fitted, source, anchors, options);
  summary.seconds += watch.seconds();
}

FittedMapping fit_mapping(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                          const FitOptions& options, const Progress& progress) {
  FittedMapping result;
  require_models(source, target, anchors, options);
  const JoinedModels joined = joined_models(result, source, target, options);
  const Anchors rated =
      lay_source(result, joined.source.mesh, joined.target.mesh, anchors, options, progress);
  hold_parts_apart(result, joined.source.mesh, options, progress);
  part_at_seams(result, joined.source);

  // IV.D, IV.E: E.
  fit_elastic_map(result, source, rated, options, progress);
  result.anchor_residual = anchor_residuals(result, anchors);
  judge_lines(result, source, target, anchors);
  return result;
}

FittedMapping fit_source_surface(const TriangleMesh& source, const TriangleMesh& target,
                                 const Anchors& anchors, const FitOptions& options,
                                 const Progress& progress) {
  FittedMapping result;
  require_models(source, target, anchors, options);
  const JoinedModels joined = joined_models(result, source, target, options);
  lay_source(result, joined.source.mesh, joined.target.mesh, anchors, options, progress);
  part_at_seams(result, joined.source);
  return result;
}

FittedMapping fit_mapping_to_fitted(const TriangleMesh& source, const TriangleMesh& fitted,
                                    const Anchors& anchors, const FitOptions& options,
                                    const Progress& progress) {
  require_usable(source, anchors, options);
  require_valid(fitted, "fitted source");
  require_same_connectivity(source, fitted);
  require_one_unit(source.vertices, fitted.vertices, "their vertices");
  if (!anchors.curves.empty())
    throw InvalidInput("curves lead the surface fitting, but the fitted source is given; leave them out");
  if (!anchors.patches.empty())
    throw InvalidInput("patches lead the surface fitting, but the fitted source is given; leave them out");
  FittedMapping result;

  const Stopwatch rigid_watch;
  progress.step("rigid", 0, 0);
  const bool by_vertices = anchors.pairs.empty();
  Points sources = source_points(anchors), targets = target_points(anchors);
  Eigen::VectorXd weights = spline_weights(anchors);
  if (by_vertices) {
    const std::vector<int> used = elastic_pairs(source, fitted.vertices).referenced;
    sources = source.vertices(Eigen::all, used);
    targets = fitted.vertices(Eigen::all, used);
    weights = Eigen::VectorXd::Ones(sources.cols());
  }
  result.target_from_source = align_rigidly(sources, targets, weights);
  result.summary.rigid = {by_vertices, rotation_angle(result.target_from_source),
                          summarize(distances(result.target_from_source * sources, targets)),
                          rigid_watch.seconds()};

  result.fitted_vertices = inverse(result.target_from_source) * fitted.vertices;
  hold_parts_apart(result, source, options, progress);
  fit_elastic_map(result, source, anchors, options, progress);
  return result;
}

}  // namespace bespoke
