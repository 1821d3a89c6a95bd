#include "bespoke/pipeline/fit_mapping.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/anchors/anchor_placement.h"
#include "bespoke/anchors/anchor_scale.h"
#include "bespoke/anchors/patch_borders.h"
#include "bespoke/anchors/size_ratio.h"
#include "bespoke/error.h"
#include "bespoke/length.h"
#include "bespoke/mesh/seams.h"
#include "bespoke/number_format.h"
#include "bespoke/pipeline/detail/fit_elastic_map.h"
#include "bespoke/pipeline/detail/hopeless_fit.h"
#include "bespoke/pipeline/detail/register_source.h"
#include "bespoke/pipeline/elastic_pairs.h"
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

/// ratio: of the models' sizes, by what they were measured.
void require_one_unit(double ratio, const std::string& what) {
  if (!tells_two_units(ratio)) return;
  throw InvalidInput("the target is " + format_number(ratio, 3) + " times as large as the source by " + what +
                     ", as if they were in two units; bring one of them, and its anchors, to the unit of the "
                     "other, or allow any size (--any-size), and the map goes from one unit to the other");
}

/// Where the target touches itself no homeomorphism exists: the parts of the fitted source are separated.
void hold_parts_apart(FittedMapping& result, const TriangleMesh& source, const FitOptions& options,
                      const Progress& progress) {
  // Parts that pass through each other more deeply are not due to a target's contact.
  constexpr double reach = 20;  // of the gap
  progress.step("contact", 0, 0);
  ContactFit apart =
      separate_contacts(source, result.fitted_vertices,
                        {.gap = options.contact_offset, .reach = reach * options.contact_offset}, progress);
  if (apart.summary.touching == 0) return;
  result.fitted_vertices = std::move(apart.vertices);
  result.summary.contact = std::move(apart.summary);
}

/// Anchors that may lie off their models know the sizes once they are multiplied to lie on them.
void require_one_unit(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                      const FitOptions& options) {
  const double ratio = size_ratio(anchors, source, target);
  require_one_unit(ratio, measured_by(anchors));
  if (!options.any_anchors) return;
  const double off = anchor_scale(target, target_points(anchors)).value_or(1) /
                     anchor_scale(source, source_points(anchors)).value_or(1);
  require_one_unit(off * ratio, "their anchors, if these lay on both");
}

void require_models(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                    const FitOptions& options) {
  require_usable(source, anchors, options);
  require_valid(target, "target");
  if (!options.any_size) require_one_unit(source, target, anchors, options);
  if (const std::string mistake = exchanged_sides(anchors, source, target); !mistake.empty())
    throw InvalidInput(mistake);
  if (!options.any_anchors) require_anchors_at_scale(anchors, source, target);
}

/// The models as the surface fitting takes them: along a seam a surface does not end.
struct JoinedModels {
  JoinedMesh source, target;
};

JoinedModels joined_models(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                           const FitOptions& options) {
  const auto join = options.surface_fit.repair_models ? joined_at_seams : left_open;
  JoinedModels joined{join(source), join(target)};
  result.summary.seams = {joined.source.joined(), joined.target.joined()};
  return joined;
}

/// What summaries list of vertices, by other numbers: one a vertex.
void renumber_lists(FitSummary& summary, const std::vector<int>& numbers) {
  const auto renumber = [&](int& vertex) { vertex = numbers[static_cast<std::size_t>(vertex)]; };
  if (std::optional<SurfaceFitSummary>& surface = summary.surface)
    for (std::vector<int>* vertices :
         {&surface->cavity_vertices, &surface->excluded_vertices, &surface->stretched_vertices})
      std::for_each(vertices->begin(), vertices->end(), renumber);
  if (summary.contact)
    for (ReleasedVertex& released : summary.contact->released) renumber(released.vertex);
  for (UnmetVertex& vertex : summary.elastic.unmet) renumber(vertex.vertex);
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
  renumber_lists(result.summary, source.first);
}

/// The source registered to the target, its parts separated. Returns the anchors as the fit took them.
Anchors register_joined(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                        const Anchors& anchors, const FitOptions& options, const Progress& progress) {
  const JoinedModels joined = joined_models(result, source, target, options);
  Anchors estimated =
      register_source(result, joined.source.mesh, joined.target.mesh, anchors, options, progress);
  hold_parts_apart(result, joined.source.mesh, options, progress);
  part_at_seams(result, joined.source);
  return estimated;
}

/// Empty where all of the source is registered. Patches may name any of its parts.
std::optional<RegisteredParts> separable_parts(const TriangleMesh& source, const TriangleMesh& target,
                                               const Anchors& anchors, const FitOptions& options) {
  const SurfaceFitOptions& fit = options.surface_fit;
  if (fit.method != SurfaceFitMethod::deformation_graph || !fit.repair_models || !anchors.patches.empty())
    return std::nullopt;
  RegisteredParts parts = parts_to_register(source, target, anchors);
  if (parts.is_whole()) return std::nullopt;
  return parts;
}

/// Of places along the mapped curve from its counterpart, mesh units.
double largest_distance(const FittedMapping& result, const AnchorCurve& curve) {
  constexpr int places = 1000;
  Points along(3, places);
  for (int i = 0; i < places; ++i) along.col(i) = point_along(curve.a, curve.closed, i / (places - 1.0));
  const Points mapped = result.target_from_source * (*result.elastic)(along);
  return distance_from_polyline(curve.b, curve.closed, mapped);
}

void measure_lines(FittedMapping& result, const TriangleMesh& source, const TriangleMesh& target,
                   const Anchors& anchors) {
  for (const AnchorCurve& curve : anchors.curves)
    result.summary.curves.push_back({curve.name, largest_distance(result, curve)});
  for (const PatchBorder& border : patch_borders(anchors, source, target)) {
    std::optional<double>& largest = result.summary.patches[border.patch].largest_distance;
    largest = std::max(largest.value_or(0), largest_distance(result, border.curve));
  }
}

}  // namespace

const TriangleMesh& registered_source(const FittedMapping& fit, const TriangleMesh& source) {
  return fit.registered ? fit.registered->mesh : source;
}

FittedMapping fit_mapping(const TriangleMesh& source, const TriangleMesh& target, const Anchors& anchors,
                          const FitOptions& options, const Progress& progress) {
  require_models(source, target, anchors, options);
  FittedMapping result;
  Anchors estimated;
  if (std::optional<RegisteredParts> parts = separable_parts(source, target, anchors, options)) {
    do {
      result = {};
      result.registered = std::make_shared<const PartialMesh>(parts->mesh(source));
      estimated = register_joined(result, result.registered->mesh, target, anchors, options, progress);
    } while (keep_uncovered(*parts, source, target, result.target_from_source * result.fitted_vertices));
    if (!parts->is_whole()) result.summary.parts = {parts->components.count(), loose_parts(*parts)};
  } else {
    estimated = register_joined(result, source, target, anchors, options, progress);
  }

  // IV.D, IV.E: E.
  const TriangleMesh& registered = registered_source(result, source);
  require_hopeful_surface(registered, result.fitted_vertices, options);
  fit_elastic_map(result, registered, estimated, options, progress);
  require_hopeful(result, registered, options);
  result.anchor_residual = anchor_residuals(result, anchors);
  if (!result.anchor_sigma.empty())
    result.summary.missed =
        missed_anchors(anchors, result.anchor_residual, result.anchor_sigma,
                       anchor_resolution * power_of_two_scale(size_ratio(anchors, source, target)) *
                           diagonal(source.vertices));
  measure_lines(result, registered, target, anchors);
  return result;
}

FittedMapping with_loose_parts(FittedMapping fit, const TriangleMesh& source) {
  if (!fit.registered) return fit;
  const std::vector<int>& numbers = fit.registered->vertices;
  Points x = source.vertices;
  for (std::size_t k = 0; k < fit.step_sources.size(); ++k) {
    x(Eigen::all, numbers) = fit.step_sources[k];
    fit.step_sources[k] = x;
    x = (*fit.elastic->steps()[k])(x);
  }
  x(Eigen::all, numbers) = fit.fitted_vertices;
  fit.fitted_vertices = std::move(x);
  if (!fit.confidence.empty()) {
    std::vector<double> confidence(static_cast<std::size_t>(source.vertices.cols()), 0.0);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      confidence[static_cast<std::size_t>(numbers[i])] = fit.confidence[i];
    fit.confidence = std::move(confidence);
  }
  for (int& vertex : fit.pairs.referenced) vertex = numbers[static_cast<std::size_t>(vertex)];
  renumber_lists(fit.summary, numbers);
  fit.registered.reset();
  return fit;
}

FittedMapping fit_source_surface(const TriangleMesh& source, const TriangleMesh& target,
                                 const Anchors& anchors, const FitOptions& options,
                                 const Progress& progress) {
  FittedMapping result;
  require_models(source, target, anchors, options);
  const JoinedModels joined = joined_models(result, source, target, options);
  register_source(result, joined.source.mesh, joined.target.mesh, anchors, options, progress);
  part_at_seams(result, joined.source);
  return result;
}

void require_same_connectivity(const TriangleMesh& source, const TriangleMesh& fitted,
                               const std::string& what) {
  if (fitted.vertices.cols() != source.vertices.cols() || fitted.faces.cols() != source.faces.cols())
    throw InvalidInput(what + " has " + std::to_string(fitted.vertices.cols()) + " vertices and " +
                       std::to_string(fitted.faces.cols()) + " faces, but the source has " +
                       std::to_string(source.vertices.cols()) + " and " +
                       std::to_string(source.faces.cols()) + "; both must have the same connectivity");
  for (Eigen::Index face = 0; face < source.faces.cols(); ++face)
    if (source.faces.col(face) != fitted.faces.col(face))
      throw InvalidInput("face " + std::to_string(face) + " of " + what +
                         " has other vertices than the source's; both must have the same connectivity");
}

FittedMapping fit_mapping_to_fitted(const TriangleMesh& source, const TriangleMesh& fitted,
                                    const Anchors& anchors, const FitOptions& options,
                                    const Progress& progress) {
  require_usable(source, anchors, options);
  require_valid(fitted, "fitted source");
  require_same_connectivity(source, fitted, "the fitted mesh");
  if (!options.any_size)
    require_one_unit(diagonal(fitted.vertices) / diagonal(source.vertices), "their vertices");
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
  result.summary.rigid = rigid_summary(result.target_from_source, sources, targets);
  result.summary.rigid.by_vertices = by_vertices;
  result.summary.rigid.seconds = rigid_watch.seconds();

  result.fitted_vertices = inverse(result.target_from_source) * fitted.vertices;
  hold_parts_apart(result, source, options, progress);
  fit_elastic_map(result, source, anchors, options, progress);
  return result;
}

}  // namespace bespoke
