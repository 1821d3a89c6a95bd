#include "bespoke/surface_fit/graph/node_fit.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "bespoke/statistics.h"
#include "bespoke/surface_fit/graph/pose_certainty.h"
#include "bespoke/surface_fit/matching/cavities.h"
#include "bespoke/surface_fit/matching/informative_areas.h"
#include "bespoke/surface_fit/matching/plane_pairs.h"

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

/// ℓ, diagonals: from the coarsest to the finest by equal factors.
double smoothing_length(const NodeFitSettings& settings, int iteration) {
  const double share = double(iteration) / (total_iterations(settings) - 1);
  return settings.coarsest_smoothing *
         std::pow(settings.finest_smoothing / settings.coarsest_smoothing, share);
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

/// Of the rest surface, without what is excluded.
Eigen::VectorXd included_areas(const TargetSurface& rest, const NodeFitSettings& settings) {
  Eigen::VectorXd areas = informative_areas(rest, settings.areas);
  for (Eigen::Index i = 0; i < areas.size(); ++i)
    if (rest.is_excluded(i)) areas[i] = 0;
  return areas;
}

/// Those vertices have zero weight.
void set_zero(const std::vector<char>& vertices, Eigen::VectorXd& areas) {
  for (std::size_t i = 0; i < vertices.size(); ++i)
    if (vertices[i]) areas[static_cast<Eigen::Index>(i)] = 0;
}

/// With as many iterations as the anchors require.
NodeFitSettings settings_for(const NodeFitInput& input, NodeFitSettings settings) {
  if (input.anchor_sources.cols() == 0) settings.levels.front().iterations = settings.unanchored_iterations;
  return settings;
}

}  // namespace

NodeFitting::NodeFitting(const NodeFitInput& input, const NodeFitSettings& settings, const Progress& progress)
    : input_(input),
      settings_(settings_for(input, settings)),
      progress_(progress),
      rest_(input.rest, input.patches),
      areas_(included_areas(rest_, settings)),
      target_areas_(informative_areas(input.target, settings.areas)),
      pose_certainty_(input.is_posed ? pose_certainty(input.rest.vertices, input.anchor_sources,
                                                      settings.outside_residuals.reach)
                                     : Eigen::VectorXd()),
      anchors_(node_anchors(input, rest_)),
      boundaries_({rest_, input.anchor_sources, input.target, input.boundaries}, settings.boundaries),
      surface_{input.rest, input.shape, rest_.areas().sum()},
      limits_(input.anchor_sigmas, surface_.area, settings.anchors),
      posterior_({input.anchor_tested, input.anchor_sigmas, surface_.area}, settings.outliers) {
  fit_.vertices = input.rest.vertices;
}

double NodeFitting::fit_coarse() {
  const NodeLevel& level = settings_.levels.front();
  const std::unique_ptr<NodeSystem> few = system(level);
  const Eigen::VectorXd areas = areas_, target_areas = target_areas_;
  if (anchors_.empty()) {
    find_unmatched_cavities();
    set_zero(fit_.unmatched_cavities.contains, areas_);
    set_zero(target_in_cavity_, target_areas_);
  }
  iterate(*few, level);
  areas_ = areas;
  target_areas_ = target_areas;
  fit_.coarse_vertices = fit_.vertices;
  fine_ = system(settings_.levels.back());
  const double strain = fine_->median_strain();
  fit_.rigidity = std::clamp(settings_.shape.usual_strain / strain, 1.0, settings_.shape.max_rigid);
  return fit_.rigidity;
}

void NodeFitting::find_unmatched_cavities() {
  if (!target_in_cavity_.empty()) return;
  fit_.unmatched_cavities = cavities_of(rest_.mesh());
  target_in_cavity_ = cavities_of(input_.target.mesh()).contains;
}

NodeFit NodeFitting::fit_fine() {
  find_unmatched_cavities();
  const TargetSurface now = rest_.moved(fit_.vertices);
  fit_.hidden = vertices_in_unmatched_cavities(now, input_.target, settings_.cavities);
  fit_.unmatched = unmatched_cavities(fit_.unmatched_cavities.parts, now.mesh(), input_.target.mesh(),
                                      target_in_cavity_, settings_.unmatched_cavities);
  for (const Cavity& cavity : fit_.unmatched)
    for (const int vertex : cavity.vertices) fit_.hidden[static_cast<std::size_t>(vertex)] = 1;
  set_zero(fit_.hidden, areas_);
  iterate(*fine_, settings_.levels.back());
  fit_.anchor_sources = carried(input_, anchors_, fit_.vertices);
  fit_.tested_anchors = posterior_.is_active();
  fit_.outliers = posterior_.outliers();
  fit_.matched_boundaries = boundaries_.matched_boundaries();
  return std::move(fit_);
}

std::unique_ptr<NodeSystem> NodeFitting::system(const NodeLevel& level) const {
  const double spacing = node_spacing(surface_.area, level.nodes, settings_.nodes);
  auto nodes = std::make_unique<NodeSystem>(
      surface_, make_deformation_nodes(input_.rest, spacing, settings_.nodes), anchors_, settings_);
  nodes->start_from(fit_.vertices);
  return nodes;
}

std::vector<PlanePair> NodeFitting::plane_pairs(const NodeLevel& level) const {
  return find_plane_pairs({rest_.moved(fit_.vertices), input_.target, areas_, target_areas_,
                           input_.is_posed && level.outside_residuals ? &pose_certainty_ : nullptr},
                          level, settings_);
}

/// Without limits of the anchors. iteration: of the level.
NodeGoals NodeFitting::goals(const std::vector<PlanePair>& planes, const std::vector<BoundaryMatch>& cuts,
                             int iteration) const {
  return {fit_.vertices,
          planes,
          cuts,
          smoothing_length(settings_, fit_.iterations),
          settings_.anchor_growth * (iteration + 1),
          {},
          fit_.rigidity,
          posterior_.inliers()};
}

/// Non-rigid iterative closest points (Amberg, Romdhani, Vetter 2007).
void NodeFitting::iterate(NodeSystem& system, const NodeLevel& level) {
  for (int iteration = 0; iteration < level.iterations; ++iteration, ++fit_.iterations) {
    progress_.step("surface-fit", static_cast<std::size_t>(fit_.iterations),
                   static_cast<std::size_t>(total_iterations(settings_)));
    const std::vector<PlanePair> planes = plane_pairs(level);
    if (fit_.iterations == settings_.boundary_start) boundaries_.decide(fit_.vertices);
    const std::vector<BoundaryMatch> cuts = boundaries_.match(fit_.vertices);
    NodeGoals now = goals(planes, cuts, iteration);
    now.anchor_limits = next_limits(now);
    fit_.vertices = system.solve(now);
    if (posterior_.is_active() && &level == &settings_.levels.front())
      fit_.vertices = solved_without_outliers(system, now);
  }
}

/// Expectation and maximisation in turn, from a solution for these goals, until the outliers stay the same.
Points NodeFitting::solved_without_outliers(NodeSystem& system, NodeGoals goals) {
  constexpr int max_rounds = 5;
  Points vertices = fit_.vertices;
  for (int round = 0; round < max_rounds; ++round) {
    const std::vector<Eigen::Index> before = posterior_.outliers();
    posterior_.update(system.left_out());
    if (posterior_.outliers() == before) break;
    goals.anchor_inliers = posterior_.inliers();
    vertices = system.solve(goals);
  }
  return vertices;
}

/// Limits for the next solve; empty where every anchor is exact or weighted.
std::vector<double> NodeFitting::next_limits(const NodeGoals& goals) {
  if (input_.anchor_sigmas.size() == 0 || !(input_.anchor_sigmas.maxCoeff() > 0)) return {};
  const Eigen::VectorXd residuals =
      (carried(input_, anchors_, goals.vertices) - input_.anchor_targets).colwise().norm();
  return limits_.next({residuals, median_distance(goals.planes, goals.vertices), goals.smoothing});
}

}  // namespace bespoke
