#include "bespoke/surface_fit/graph/node_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/median.h"
#include "bespoke/parallel.h"

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
        std::vector<FollowedAnchor> combined;
        for (const NodeAnchor& anchor : anchors)
          combined.push_back(
              {nodes_.at_point(anchor.foot, surface.rest.faces), anchor.displacement, anchor.weight});
        return combined;
      }()),
      system_(adjacency(), nodes_.rest),
      displacements_(Points::Zero(3, nodes_.size())) {}

std::vector<std::vector<int>> NodeSystem::adjacency() const {
  std::vector<std::vector<int>> rows(static_cast<std::size_t>(nodes_.size()));
  for (int node = 0; node < nodes_.size(); ++node) {
    std::vector<int> stencil = nodes_.neighbours[node];
    stencil.push_back(node);
    couple(stencil, rows);
  }
  for (const FollowedAnchor& anchor : anchors_) {
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

Points NodeSystem::solve(const NodeGoals& goals) {
  const EnergyInput input{surface_, nodes_, shape_, anchors_, settings_};
  const RegistrationEnergy energy(input, goals, displacements_);
  system_.set_zero();
  for (const EnergyTerm term : energy_terms) energy.add_step(term, system_);
  for (int node = 0; node < nodes_.size(); ++node)
    system_.add(node, node, settings_.free_floating * Matrix3::Identity());
  anchor_weights_.clear();
  for (std::size_t k = 0; k < anchors_.size(); ++k) anchor_weights_.push_back(energy.anchor_weight(k));
  displacements_ = system_.solve();
  return moved_vertices();
}

LeftOutAnchors NodeSystem::left_out() const {
  const auto count = static_cast<Eigen::Index>(anchors_.size());
  LeftOutAnchors result{Eigen::VectorXd(count), Eigen::VectorXd(count)};
  parallel_for(anchors_.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      Vector3 residual = -anchors_[k].displacement;
      for (const auto& [node, weight] : anchors_[k].foot) residual += weight * displacements_.col(node);
      const Matrix3 compliance = system_.compliance(anchors_[k].foot);
      const Matrix3 without = (Matrix3::Identity() - anchor_weights_[k] * compliance).inverse();
      result.distances[static_cast<Eigen::Index>(k)] = (without * residual).norm();
      result.compliances[static_cast<Eigen::Index>(k)] = (without * compliance).trace() / 3;
    }
  });
  return result;
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

double NodeSystem::median_strain() const {
  const Points places = nodes_.rest + displacements_;
  std::vector<double> strains;
  for (int node = 0; node < nodes_.size(); ++node) {
    const auto [rotation, scale] = local_similarity(nodes_, shape_, displacements_, node);
    double misfit = 0, total = 0;
    for (const int other : nodes_.neighbours[node]) {
      const Vector3 now = places.col(other) - places.col(node);
      misfit += (now - scale * (rotation * (shape_.col(other) - shape_.col(node)))).squaredNorm();
      total += now.squaredNorm();
    }
    if (total > 0) strains.push_back(std::sqrt(misfit / total));
  }
  return strains.empty() ? 0 : median(strains);
}

}  // namespace bespoke
