#pragma once

#include <memory>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"

namespace bespoke {

/// A surface bent by its anchors alone.
struct AnchorPose {
  Points vertices;        ///< 3×n, diagonals
  Points anchor_sources;  ///< 3×k, carried along
};

struct AnchorPoseInput {
  const TriangleMesh& rest;       ///< aligned with the targets by one similarity
  const Points& anchor_sources;   ///< 3×k, aligned like `rest`; need not lie on it
  const Points& anchor_targets;   ///< 3×k
  const Eigen::VectorXd& sigmas;  ///< k, accuracies of the anchors, ≥ 0, diagonals
};

/// As-similar-as-possible modelling (Sorkine, Alexa 2007; Igarashi 2005): takes the anchors to their targets
/// with
///   min Σᵢⱼ |(x'ⱼ − x'ᵢ) − Mᵢ (xⱼ − xᵢ)|² + β h² Σᵢⱼ |Mᵢ − Mⱼ|² + anchors / σ²,  Mᵢ = sᵢ Rᵢ,
/// h the spacing of the nodes, before any closest point is queried. Alternates between similarities and
/// places, coarse nodes first. Without anchors nothing moves. Same bytes at any thread count.
class PosingByAnchors {
 public:
  /// Poses the few nodes. What `input` refers to must outlive it. Throws SolverError.
  explicit PosingByAnchors(const AnchorPoseInput& input, const PoseSettings& settings = {});
  ~PosingByAnchors();

  /// Largest angle between a node's rotation and the mean one, radians.
  double rotation_spread() const;

  /// As many nodes pose it. Throws SolverError.
  AnchorPose bent() const;

 private:
  class Nodes;
  AnchorPoseInput input_;
  PoseSettings settings_;
  std::unique_ptr<Nodes> coarse_;  // null without anchors
};

}  // namespace bespoke
