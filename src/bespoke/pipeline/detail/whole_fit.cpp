#include "bespoke/pipeline/detail/whole_fit.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/anchors/patch_borders.h"
#include "bespoke/anchors/size_ratio.h"
#include "bespoke/length.h"
#include "bespoke/registration/renumbered.h"

namespace bespoke {
namespace {

/// Of places along the mapped curve from its counterpart, mesh units.
double largest_distance(const RigidTransform& target_from_source, const ElasticMap& elastic,
                        const AnchorCurve& curve) {
  constexpr int places = 1000;
  Points along(3, places);
  for (int i = 0; i < places; ++i) along.col(i) = point_along(curve.a, curve.closed, i / (places - 1.0));
  return distance_from_polyline(curve.b, curve.closed, target_from_source * elastic(along));
}

/// Values of a part's vertices as values of the whole source's.
std::vector<double> spread_values(const std::vector<double>& values, const std::vector<int>& numbers,
                                  Eigen::Index count) {
  std::vector<double> all(static_cast<std::size_t>(count), 0.0);
  for (std::size_t i = 0; i < numbers.size(); ++i) all[static_cast<std::size_t>(numbers[i])] = values[i];
  return all;
}

/// A fit of some of the source's vertices, by their numbers, as one of all.
FittedMapping of_all_vertices(FittedMapping fit, const Points& vertices, const std::vector<int>& numbers) {
  Points x = vertices;
  for (std::size_t k = 0; k < fit.step_sources.size(); ++k) {
    x(Eigen::all, numbers) = fit.step_sources[k];
    fit.step_sources[k] = x;
    x = (*fit.elastic->steps()[k])(x);
  }
  x(Eigen::all, numbers) = fit.fitted_vertices;
  fit.fitted_vertices = std::move(x);
  if (!fit.confidence.empty()) fit.confidence = spread_values(fit.confidence, numbers, vertices.cols());
  RegistrationSummary& registration = fit.summary;
  registration = renumbered(std::move(registration), numbers);
  fit.summary.elastic = renumbered(std::move(fit.summary.elastic), numbers);
  return fit;
}

}  // namespace

MapFindings map_findings(const Problem& problem, const Registration& registration, const MapFit& fit,
                         const FitOptions& options) {
  MapFindings findings;
  findings.patches = registration.summary.patches;
  if (problem.fitted) return findings;
  const Anchors& anchors = problem.anchors;
  if (!registration.anchor_sigma.empty()) {
    const double size = power_of_two_scale(size_ratio(anchors, problem.source, problem.target)) *
                        diagonal(problem.source.vertices);
    findings.missed = missed_anchors(anchors, anchor_residuals(fit, registration, anchors),
                                     registration.anchor_sigma, anchor_resolution * size);
  }
  const RigidTransform& target_from_source = registration.target_from_source;
  for (const AnchorCurve& curve : anchors.curves)
    findings.curves.push_back({curve.name, largest_distance(target_from_source, *fit.elastic, curve)});
  const TriangleMesh& source = registered_mesh(registration, problem.source);
  if (options.surface_fit.method == SurfaceFitMethod::deformation_graph)
    findings.stretched =
        stretched_edges(source, (*fit.elastic)(source.vertices), options.surface_fit.max_stretch);
  for (const PatchBorder& border : patch_borders(anchors, source, problem.target)) {
    std::optional<double>& largest = findings.patches[border.patch].largest_distance;
    largest = std::max(largest.value_or(0), largest_distance(target_from_source, *fit.elastic, border.curve));
  }
  return findings;
}

FittedMapping whole_fit(const Problem& problem, const Registration& registration, const MapFit& fit,
                        const MapFindings& findings) {
  FittedMapping whole;
  whole.target_from_source = registration.target_from_source;
  whole.elastic = fit.elastic;
  whole.step_sources = fit.step_sources;
  whole.fitted_vertices = registration.fitted_vertices;
  whole.confidence = registration.confidence;
  whole.anchor_residual = anchor_residuals(fit, registration, problem.anchors);
  whole.anchor_sigma = registration.anchor_sigma;
  whole.plan = fit.plan;
  static_cast<RegistrationSummary&>(whole.summary) = registration.summary;
  whole.summary.elastic = fit.summary;
  whole.summary.elastic.anchor_residuals = summarize(whole.anchor_residual);
  whole.summary.missed = findings.missed;
  whole.summary.stretched = findings.stretched;
  whole.summary.curves = findings.curves;
  whole.summary.patches = findings.patches;
  if (!registration.part) return whole;
  return of_all_vertices(std::move(whole), problem.source.vertices, registration.part->vertices);
}

}  // namespace bespoke
