#include "bespoke/surface_fit/detail/node_fit.h"

#include <cmath>
#include <utility>
#include <vector>

#include "bespoke/statistics.h"
#include "bespoke/surface_fit/detail/anchor_limits.h"
#include "bespoke/surface_fit/detail/boundary_match.h"
#include "bespoke/surface_fit/detail/cavities.h"
#include "bespoke/surface_fit/detail/informative_areas.h"
#include "bespoke/surface_fit/detail/node_system.h"
#include "bespoke/surface_fit/detail/plane_pairs.h"

namespace bespoke {
namespace {

std::vector<NodeAnchor> node_anchors(const NodeFitInput& input, const TargetSurface& rest) {
  std::vector<NodeAnchor> anchors;
  for (Eigen::Index k = 0; k < input.anchor_sources.cols(); ++k)
    anchors.push_back({rest.closest(input.anchor_sources.col(k)),
                       input.anchor_targets.col(k) - input.anchor_sources.col(k), input.anchor_weights[k]});
  return anchors;
}

int total_iterations(const NodeFitSettings& settings) {
  int total = 0;
  for (const NodeLevel& level : settings.levels) total += level.iterations;
  return total;
}

/// ℓ, mesh units: from the coarsest to the finest by equal factors.
double smoothing_length(const NodeFitSettings& settings, int iteration, double diagonal) {
  const double share = double(iteration) / (total_iterations(settings) - 1);
  return settings.coarsest_smoothing *
         std::pow(settings.finest_smoothing / settings.coarsest_smoothing, share) * diagonal;
}

/// Points (3×k) on the rest surface, moved with it.
Points carried(const NodeFitInput& input, const std::vector<NodeAnchor>& anchors, const Points& vertices) {
  Points places = input.anchor_sources;
  for (std::size_t k = 0; k < anchors.size(); ++k)
    for (int corner = 0; corner < 3; ++corner) {
      const SurfacePoint& foot = anchors[k].foot;
      const int vertex = input.rest.faces(corner, foot.face);
      places.col(static_cast<Eigen::Index>(k)) +=
          foot.barycentric[corner] * (vertices.col(vertex) - input.rest.vertices.col(vertex));
    }
  return places;
}

double median_distance(const std::vector<PlanePair>& planes, const Points& vertices) {
  std::vector<double> distances;
  for (const PlanePair& plane : planes)
    distances.push_back((plane.point - vertices.col(plane.vertex)).norm());
  return summarize(std::move(distances)).median;
}

/// Limits for the next solve; empty where every anchor is exact or weighted.
std::vector<double> next_limits(const NodeFitInput& input, const std::vector<NodeAnchor>& anchors,
                                const NodeGoals& goals, AnchorLimits& limits) {
  if (input.anchor_sigmas.size() == 0 || !(input.anchor_sigmas.maxCoeff() > 0)) return {};
  const Eigen::VectorXd residuals =
      (carried(input, anchors, goals.vertices) - input.anchor_targets).colwise().norm();
  return limits.next({residuals, median_distance(goals.planes, goals.vertices), goals.smoothing});
}

}  // namespace

NodeFit fit_nodes(const NodeFitInput& input, const NodeFitSettings& settings, const Progress& progress) {
  const TargetSurface rest(input.rest, input.patches);
  Eigen::VectorXd areas = informative_areas(rest, input.diagonal, settings.areas);
  const Eigen::VectorXd target_areas = informative_areas(input.target, input.diagonal, settings.areas);
  const std::vector<NodeAnchor> anchors = node_anchors(input, rest);
  BoundaryMatcher boundaries({rest, input.anchor_sources, input.target, input.boundaries},
                             settings.boundaries);
  const NodeSurface node_surface{input.rest, areas.sum(), input.diagonal};
  for (Eigen::Index i = 0; i < areas.size(); ++i)
    if (rest.is_excluded(i)) areas[i] = 0;
  AnchorLimits limits(input.anchor_sigmas, node_surface.area, input.diagonal, settings.anchors);

  NodeFit fit;
  fit.vertices = input.rest.vertices;
  for (const NodeLevel& level : settings.levels) {
    if (&level == &settings.levels[1]) {
      fit.coarse_vertices = fit.vertices;
      fit.hidden = vertices_in_lacking_cavities(rest.moved(fit.vertices), input.target, input.diagonal,
                                                settings.cavities);
      for (std::size_t i = 0; i < fit.hidden.size(); ++i)
        if (fit.hidden[i]) areas[static_cast<Eigen::Index>(i)] = 0;
    }
    const double spacing = node_spacing(node_surface.area, level.nodes, settings.nodes);
    NodeSystem system(node_surface, make_deformation_nodes(input.rest, spacing, settings.nodes), anchors,
                      settings);
    system.start_from(fit.vertices);
    for (int iteration = 0; iteration < level.iterations; ++iteration, ++fit.iterations) {
      progress.step("surface-fit", static_cast<std::size_t>(fit.iterations),
                    static_cast<std::size_t>(total_iterations(settings)));
      std::vector<PlanePair> planes;
      // Before the anchors are met, closest points mislead.
      if (fit.iterations > 0 || anchors.empty())
        planes = find_plane_pairs(
            {rest.moved(fit.vertices), input.target, areas, target_areas, input.diagonal}, level, settings);
      if (fit.iterations == settings.boundary_start) boundaries.decide(fit.vertices);
      const std::vector<BoundaryMatch> cuts = boundaries.match(fit.vertices);
      NodeGoals goals{fit.vertices, planes, cuts, smoothing_length(settings, fit.iterations, input.diagonal),
                      settings.anchor_growth * (iteration + 1)};
      goals.anchor_limits = next_limits(input, anchors, goals, limits);
      fit.vertices = system.solve(goals);
    }
  }
  fit.anchor_sources = carried(input, anchors, fit.vertices);
  fit.matched_boundaries = boundaries.matched_boundaries();
  return fit;
}

}  // namespace bespoke
