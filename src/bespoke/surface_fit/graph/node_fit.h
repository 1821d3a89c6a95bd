#pragma once

#include <memory>
#include <vector>

#include "bespoke/progress.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/graph/anchor_limits.h"
#include "bespoke/surface_fit/graph/anchor_posterior.h"
#include "bespoke/surface_fit/graph/node_system.h"
#include "bespoke/surface_fit/matching/boundary_match.h"
#include "bespoke/surface_fit/matching/plane_pairs.h"
#include "bespoke/surface_fit/matching/target_surface.h"
#include "bespoke/surface_fit/matching/unmatched_cavities.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// What the deformation of a surface by nodes works on. Lengths in diagonals.
struct NodeFitInput {
  const TriangleMesh& rest;  ///< the source, aligned with the target, and perhaps bent by its anchors
  const Points& shape;       ///< 3×n: the same before it was bent, whose shape is kept
  const TargetSurface& target;
  const Points& anchor_sources;  ///< 3×k, aligned like `rest`, on it or near it
  const Points& anchor_targets;  ///< 3×k
  /// k: infinite, or the percentage of the surface's area that a soft anchor counts like.
  const Eigen::VectorXd& anchor_weights;
  BoundaryRule boundaries = BoundaryRule::automatic;
  /// k, ≥ 0, diagonals: accuracies of anchors of infinite weight; empty is 0 for all.
  Eigen::VectorXd anchor_sigmas = {};
  /// Of the faces of `rest`; those of the target it knows itself. Excluded ones have no pairs.
  FacePatches patches = {};
  bool is_posed = false;                 ///< whether anchors have bent `rest`
  std::vector<char> anchor_tested = {};  ///< k: whether it may be an outlier; empty: none may
};

struct NodeFit {
  Points vertices;                     ///< 3×n, of the deformed `rest`
  Points coarse_vertices;              ///< 3×n, as the few nodes of the first level left them
  Points anchor_sources;               ///< 3×k, carried along
  bool tested_anchors = false;         ///< whether outliers among them would have been found
  std::vector<Eigen::Index> outliers;  ///< anchors that the fit left out
  Cavities unmatched_cavities;         ///< of `rest`
  std::vector<Cavity> unmatched;       ///< of them, those that the target lacks
  std::vector<char> hidden;            ///< n: in a cavity that the target lacks, without any pair
  int iterations = 0;
  int matched_boundaries = 0;
  double rigidity = 1;  ///< g of the pair, from NodeFitting::fit_coarse
};

/// Smooth deformation onto the target by an embedded deformation graph (Sumner 2007), coarse to fine;
/// node_system.h has the energy. Its smoothing length ℓ falls geometrically; second differences follow the
/// surface as it lies now, so that the inverse bends least. After the first level cavities that the target
/// lacks (cavities.h, unmatched_cavities.h) have no pairs, and the similarities count by the pair's rigidity.
/// Without anchors no cavity (mesh/cavities.h) has pairs in the first level.
class NodeFitting {
 public:
  /// The input's references and the progress must outlive it.
  NodeFitting(const NodeFitInput& input, const NodeFitSettings& settings, const Progress& progress);

  /// The first level. Returns the rigidity g ≥ 1 of the pair (NodeGoals), 1 where bodies differ as they
  /// mostly do. Throws SolverError.
  double fit_coarse();

  /// The second, after the first. Throws SolverError.
  NodeFit fit_fine();

 private:
  std::unique_ptr<NodeSystem> system(const NodeLevel& level) const;
  void iterate(NodeSystem& system, const NodeLevel& level);
  std::vector<PlanePair> plane_pairs(const NodeLevel& level) const;
  NodeGoals goals(const std::vector<PlanePair>& planes, const std::vector<BoundaryMatch>& cuts,
                  int iteration) const;
  std::vector<double> next_limits(const NodeGoals& goals);
  Points solved_without_outliers(NodeSystem& system, NodeGoals goals);
  void find_unmatched_cavities();

  const NodeFitInput input_;
  const NodeFitSettings settings_;  // as the input needs them
  const Progress& progress_;
  TargetSurface rest_;
  Eigen::VectorXd areas_, target_areas_;
  Eigen::VectorXd pose_certainty_;  // empty unless anchors have bent the rest surface
  std::vector<NodeAnchor> anchors_;
  BoundaryMatcher boundaries_;
  NodeSurface surface_;
  AnchorLimits limits_;
  AnchorPosterior posterior_;
  std::vector<char> target_in_cavity_;  // found with the cavities
  NodeFit fit_;
  std::unique_ptr<NodeSystem> fine_;  // of the second level, from the end of the first on
};

}  // namespace bespoke
