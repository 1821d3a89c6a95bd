#include "bespoke/surface_fit/detail/node_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/median.h"
#include "bespoke/parallel.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

/// Appends `ids` to the rows of all of them.
void couple(const std::vector<int>& ids, std::vector<std::vector<int>>& rows) {
  for (const int id : ids) rows[id].insert(rows[id].end(), ids.begin(), ids.end());
}

}  // namespace

NodeSystem::NodeSystem(const NodeSurface& surface, DeformationNodes nodes,
                       const std::vector<NodeAnchor>& anchors, const NodeFitSettings& settings)
    : surface_(surface),
      settings_(settings),
      nodes_(std::move(nodes)),
      shape_(surface.shape(Eigen::all, nodes_.vertices)),
      anchors_([&] {
        std::vector<Anchor> combined;
        for (const NodeAnchor& anchor : anchors)
          combined.push_back(
              {nodes_.at_point(anchor.foot, surface.rest.faces), anchor.displacement, anchor.weight});
        return combined;
      }()),
      system_(adjacency()),
      displacements_(Points::Zero(3, nodes_.size())) {}

std::vector<std::vector<int>> NodeSystem::adjacency() const {
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(nodes_.size()));
  for (int node = 0; node < nodes_.size(); ++node) {
    std::vector<int> stencil = nodes_.neighbours[node];
    stencil.push_back(node);
    couple(stencil, rows);
  }
  for (const Anchor& anchor : anchors_) {
    std::vector<int> ids;
    for (const NodeWeight& entry : anchor.foot) ids.push_back(entry.node);
    couple(ids, rows);
  }
  std::vector<std::vector<int>> followers(rows.size());
  for (int vertex = 0; vertex < static_cast<int>(nodes_.vertex_nodes.cols()); ++vertex)
    for (const NodeWeight& entry : nodes_.at_vertex(vertex)) followers[entry.node].push_back(vertex);
  // Thousands of vertices repeat the same nodes.
  constexpr int nobody = -1;
  std::vector<int> last_coupled(rows.size(), nobody);
  for (int node = 0; node < nodes_.size(); ++node)
    for (const int vertex : followers[node])
      for (const NodeWeight& entry : nodes_.at_vertex(vertex))
        if (std::exchange(last_coupled[entry.node], node) != node) rows[node].push_back(entry.node);
  return rows;
}

void NodeSystem::start_from(const Points& vertices) {
  constexpr double tiny = 1e-300;  // a node that no vertex has first stays where it is
  Points sum = Points::Zero(3, nodes_.size());
  Eigen::VectorXd total = Eigen::VectorXd::Constant(nodes_.size(), tiny);
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const int nearest = nodes_.vertex_nodes(0, i);
    const double weight = nodes_.vertex_weights(0, i);
    sum.col(nearest) += weight * (vertices.col(i) - surface_.rest.vertices.col(i));
    total[nearest] += weight;
  }
  displacements_ = sum * total.cwiseInverse().asDiagonal();
}

/// One step of Gauss-Newton on an embedded deformation graph (Sumner, Schmid, Pauly 2007).
Points NodeSystem::solve(const NodeGoals& goals) {
  system_.set_zero();
  add_planes(goals);
  add_boundary(goals.boundary);
  add_anchors(goals);
  const double smoothing = goals.smoothing / nodes_.spacing;
  const LocalSimilarities similarities = local_similarities();
  add_bending(std::pow(smoothing, 4) / std::pow(goals.rigidity, 2), similarities);
  add_local_similarity(std::pow(goals.rigidity * settings_.shape.share * smoothing, 2), similarities);
  displacements_ = system_.solve();
  return moved_vertices();
}

Points NodeSystem::moved_vertices() const {
  Points moved = surface_.rest.vertices;
  constexpr std::size_t grain = 128;
  parallel_for(static_cast<std::size_t>(moved.cols()), grain, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
      moved.col(i) += nodes_.displacement(displacements_, i);
  });
  return moved;
}

/// |form^(1/2) (rest + displacement − goal)|² at a combination of nodes.
template <class Nodes>
void NodeSystem::add_quadratic(const Nodes& combination, const Matrix3& form,
                               const Vector3& goal_displacement) {
  const Vector3 pull = form * goal_displacement;
  for (const NodeWeight& a : combination) {
    system_.add_right_side(a.node, a.weight * pull);
    for (const NodeWeight& b : combination)
      if (a.node >= b.node) system_.add(a.node, b.node, (a.weight * b.weight) * form);
  }
}

/// Point to plane (Chen, Medioni 1992) with Cauchy's M-estimator, iteratively reweighted: a residual of the
/// scale has weight 1/2.
void NodeSystem::add_planes(const NodeGoals& goals) {
  if (goals.planes.empty()) return;
  std::vector<double> distances;
  for (const PlanePair& plane : goals.planes)
    distances.push_back((plane.point - goals.vertices.col(plane.vertex)).norm());
  const double scale =
      settings_.outlier_medians * median(distances) + settings_.outlier_floor * surface_.diagonal;
  for (std::size_t k = 0; k < goals.planes.size(); ++k) {
    const PlanePair& plane = goals.planes[k];
    const double outlier =
        distances[k] / (scale + settings_.outlier_scale_gain * goals.smoothing * plane.outlier_scale_gain);
    const double weight = plane.weight / surface_.area / (1 + outlier * outlier);
    add_quadratic(nodes_.at_vertex(plane.vertex), weight * plane.normal * plane.normal.transpose(),
                  plane.point - surface_.rest.vertices.col(plane.vertex));
  }
}

void NodeSystem::add_boundary(const std::vector<BoundaryMatch>& boundary) {
  for (const BoundaryMatch& match : boundary) {
    // Like a strip of surface, one node spacing wide; free to slide along the cut.
    const double weight = match.length * nodes_.spacing / surface_.area;
    add_quadratic(nodes_.at_vertex(match.vertex),
                  weight * (Matrix3::Identity() - match.tangent * match.tangent.transpose()),
                  match.point - surface_.rest.vertices.col(match.vertex));
  }
}

void NodeSystem::add_anchors(const NodeGoals& goals) {
  for (std::size_t k = 0; k < anchors_.size(); ++k) {
    const Anchor& anchor = anchors_[k];
    double weight = anchor.weight / settings_.whole_surface_weight;
    if (std::isinf(anchor.weight)) {
      weight = goals.exact_anchor_weight / double(anchors_.size());
      if (!goals.anchor_limits.empty()) weight = std::min(weight, goals.anchor_limits[k]);
    }
    add_quadratic(anchor.foot, weight * Matrix3::Identity(), anchor.displacement);
  }
}

/// Thin-plate energy: squared second differences of the displacements, by area.
void NodeSystem::add_bending(double weight, const LocalSimilarities& similarities) {
  const std::vector<BendingStencil> stencils =
      bending_stencils(nodes_, nodes_.rest + displacements_, settings_.bending);
  for (int node = 0; node < nodes_.size(); ++node) {
    const BendingStencil& stencil = stencils[node];
    const double growth = similarities.growth(node, settings_.bending.max_growth);
    const double share = weight * growth * growth * nodes_.areas[node];
    for (std::size_t a = 0; a < stencil.ids.size(); ++a)
      for (std::size_t b = 0; b < stencil.ids.size(); ++b)
        system_.add(stencil.ids[a], stencil.ids[b],
                    share * stencil.quadratic(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
                        Matrix3::Identity());
    system_.add(node, node, settings_.free_floating * Matrix3::Identity());
  }
}

Vector3 NodeSystem::edge_now(int node, int other) const {
  return nodes_.rest.col(other) - nodes_.rest.col(node) + displacements_.col(other) -
         displacements_.col(node);
}

Vector3 NodeSystem::shape_edge(int node, int other) const { return shape_.col(other) - shape_.col(node); }

/// Local step of the as-similar-as-possible term: the least-squares similarity of a node's edges.
NodeSystem::LocalSimilarity NodeSystem::local_similarity(int node) const {
  Matrix3 covariance = Matrix3::Zero();
  double spread = 0;
  for (const int other : nodes_.neighbours[node]) {
    covariance += edge_now(node, other) * shape_edge(node, other).transpose();
    spread += shape_edge(node, other).squaredNorm();
  }
  if (!(spread > 0)) return {};
  const Matrix3 rotation = nearest_rotation(covariance).rotation;
  return {rotation, (rotation.transpose() * covariance).trace() / spread};
}

double NodeSystem::LocalSimilarities::growth(int node, double most) const {
  if (!(usual_scale > 0)) return 1;
  return std::clamp(around[static_cast<std::size_t>(node)].scale / usual_scale, 1 / most, most);
}

NodeSystem::LocalSimilarities NodeSystem::local_similarities() const {
  LocalSimilarities result;
  std::vector<double> scales;
  for (int node = 0; node < nodes_.size(); ++node) {
    result.around.push_back(local_similarity(node));
    scales.push_back(result.around.back().scale);
  }
  result.usual_scale = median(std::move(scales));
  return result;
}

/// Global step of the as-similar-as-possible term (Igarashi, Moscovich, Hughes 2005; Sorkine, Alexa 2007):
/// Σ |x'ⱼ − x'ᵢ − sᵢ Rᵢ eᵢⱼ|² over the edges of the graph.
void NodeSystem::add_local_similarity(double weight, const LocalSimilarities& similarities) {
  const double usual = similarities.usual_scale;
  for (int node = 0; node < nodes_.size(); ++node) {
    const auto& [rotation, found] = similarities.around[static_cast<std::size_t>(node)];
    const double scale =
        usual > 0 && found > 0 ? usual * std::pow(found / usual, settings_.shape.scale_freedom) : found;
    const double share = weight * nodes_.areas[node] / double(nodes_.neighbours[node].size());
    const Matrix3 form = share * Matrix3::Identity();
    for (const int other : nodes_.neighbours[node]) {
      const Vector3 rest = nodes_.rest.col(other) - nodes_.rest.col(node);
      const Vector3 pull = share * (scale * (rotation * shape_edge(node, other)) - rest);
      system_.add(node, node, form);
      system_.add(other, other, form);
      system_.add(std::max(node, other), std::min(node, other), -form);
      system_.add_right_side(other, pull);
      system_.add_right_side(node, -pull);
    }
  }
}

double NodeSystem::median_strain() const {
  std::vector<double> strains;
  for (int node = 0; node < nodes_.size(); ++node) {
    const auto [rotation, scale] = local_similarity(node);
    double misfit = 0, total = 0;
    for (const int other : nodes_.neighbours[node]) {
      const Vector3 now = edge_now(node, other);
      misfit += (now - scale * (rotation * shape_edge(node, other))).squaredNorm();
      total += now.squaredNorm();
    }
    if (total > 0) strains.push_back(std::sqrt(misfit / total));
  }
  return strains.empty() ? 0 : median(strains);
}

}  // namespace bespoke
