#pragma once

#include <vector>

#include "bespoke/surface_fit/graph/anchor_posterior.h"
#include "bespoke/surface_fit/graph/block_system.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"
#include "bespoke/surface_fit/graph/registration_energy.h"

namespace bespoke {

/// Minimises the energy over the displacements of the nodes of one level. Not thread-safe.
class NodeSystem {
 public:
  /// The settings must outlive the system.
  NodeSystem(const NodeSurface& surface, DeformationNodes nodes, const std::vector<NodeAnchor>& anchors,
             const NodeFitSettings& settings);

  /// Displacements that put the vertices (3×n) where a coarser level left them, weighted means around each
  /// node.
  void start_from(const Points& vertices);

  /// One Gauss–Newton step of RegistrationEnergy, plus free_floating |d|², which determines nodes that
  /// nothing else does. Returns where the vertices go, 3×n. Throws SolverError.
  Points solve(const NodeGoals& goals);

  /// Each anchor against the last step without it.
  LeftOutAnchors left_out() const;

  /// Half of the nodes have edges that differ less from the turned and scaled ones of the shape: root mean
  /// square over the node, of the edges' length.
  double median_strain() const;

 private:
  std::vector<std::vector<int>> adjacency() const;
  Points moved_vertices() const;

  NodeSurface surface_;
  const NodeFitSettings& settings_;
  DeformationNodes nodes_;
  Points shape_;  // 3×k, of the nodes
  std::vector<FollowedAnchor> anchors_;
  BlockSystem system_;
  Points displacements_;
  std::vector<double> anchor_weights_;  // of the last step
};

}  // namespace bespoke
