#pragma once

#include <array>
#include <vector>

#include "bespoke/rigid/rigid_transform.h"
#include "bespoke/surface_fit/graph/block_system.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"
#include "bespoke/surface_fit/matching/boundary_match.h"
#include "bespoke/surface_fit/matching/plane_pairs.h"

namespace bespoke {

/// An anchor as the nodes see it.
struct NodeAnchor {
  SurfacePoint foot;     ///< the nearest point of the rest surface, which the anchor moves
  Vector3 displacement;  ///< from the anchor to its target, diagonals
  double weight = 0;     ///< infinite, or the percentage of the surface's area that a soft anchor counts like
};

/// What the nodes are to be solved for. Lengths in diagonals.
struct NodeGoals {
  const Points& vertices;  ///< 3×n, where the pairs were found
  const std::vector<PlanePair>& planes;
  const std::vector<BoundaryMatch>& boundary;
  double smoothing = 0;            ///< ℓ
  double exact_anchor_weight = 0;  ///< of all exact anchors together; the surface has 1
  /// k: the most that each anchor of infinite weight may pull (anchor_limits.h); empty: no limit.
  std::vector<double> anchor_limits = {};
  double rigidity = 1;  ///< g, ≥ 1: how much more than other pairs this one keeps its shape
  /// k: by which the anchors' weights are multiplied (AnchorPosterior); empty: 1.
  std::vector<double> anchor_inliers = {};
};

/// The surface that the nodes deform.
struct NodeSurface {
  const TriangleMesh& rest;  ///< must outlive the energy
  /// 3×n, aligned like `rest`: the shape to keep, which is that of `rest` unless a pose has bent it.
  const Points& shape;
  double area = 0;
};

/// An anchor's foot as a combination of nodes.
struct FollowedAnchor {
  std::vector<NodeWeight> foot;
  Vector3 displacement;
  double weight;
};

/// Nodes, and what they carry. All must outlive the energy.
struct EnergyInput {
  const NodeSurface& surface;
  const DeformationNodes& nodes;
  const Points& shape;  ///< 3×k, of the nodes
  const std::vector<FollowedAnchor>& anchors;
  const NodeFitSettings& settings;
};

/// The least-squares similarity of a node's edges, without its translation (Umeyama 1991).
struct LocalSimilarity {
  Matrix3 rotation = Matrix3::Zero();
  double scale = 0;
};
LocalSimilarity local_similarity(const DeformationNodes& nodes, const Points& shape,
                                 const Points& displacements, int node);

enum class EnergyTerm { data, cuts, anchors, bending, shape };
inline constexpr std::array energy_terms{EnergyTerm::data, EnergyTerm::cuts, EnergyTerm::anchors,
                                         EnergyTerm::bending, EnergyTerm::shape};

// clang-format off
/// The energy of a registration over the displacements d of the nodes of an embedded deformation graph
/// (Sumner, Schmid, Pauly 2007), which move the rest surface, φ(x) = x + Σ_k ω_k(x) d_k; A is the surface's
/// area:
///
///   data     Σ_i w_i/A (n_i · (φ(x_i) − y_i))²    both ways; point to plane (Chen, Medioni 1992)
///   cuts     Σ_b h_b/A |P_b (φ(x_b) − y_b)|²      boundaries that are the same cut, P across it
///   anchors  Σ_k w_k |φ(a_k) − q_k|²              where anchors lie on the target
///   bending  ℓ⁴/g² Σ_j A_j γ_j² |D_j d|²          thin plate: what no affine map around node j explains
///   shape    (g s ℓ)² Σ_j A_j mean_k |φ(x_k) − φ(x_j) − c_j R_j e_jk|²
///                                                 as similar as possible, R_j the best rotation of the shape's
///                                                 edges e_jk (Igarashi et al. 2005; Sorkine, Alexa 2007)
///
/// w_i is the pair's area times its probability of being right, by distance (Cauchy's M-estimator; its scale
/// is that of the residuals), normals and reciprocity (PlanePair::weight). ℓ is the smoothing length in
/// spacings of nodes, g the rigidity. w, γ, D and c are those of the displacements `now`: iteratively
/// reweighted least squares (Holland, Welsch 1977). The orientation of faces is no term: flipped faces are
/// repaired afterwards.
// clang-format on
class RegistrationEnergy {
 public:
  /// now: 3×k. The goals must outlive it.
  RegistrationEnergy(const EnergyInput& input, const NodeGoals& goals, const Points& now);

  /// displacements: 3×k.
  double value(EnergyTerm term, const Points& displacements) const;

  /// w_k of an anchor.
  double anchor_weight(std::size_t anchor) const;

  /// Adds the normal equations of the Gauss–Newton step from `now`: R_j stays.
  void add_step(EnergyTerm term, BlockSystem& system) const;

 private:
  template <class Visitor>
  void for_each_plane(const Visitor& visit) const;
  template <class Visitor>
  void for_each_cut(const Visitor& visit) const;
  template <class Visitor>
  void for_each_anchor(const Visitor& visit) const;
  template <class Visitor>
  void for_each_place(EnergyTerm term, const Visitor& visit) const;
  double bending(const Points& displacements) const;
  double shape(const Points& displacements) const;
  void add_bending(BlockSystem& system) const;
  void add_shape(BlockSystem& system) const;
  /// Of a node, for the mean over its edges.
  double shape_weight(int node) const;

  const EnergyInput input_;
  const NodeGoals& goals_;
  double smoothing_;                           // ℓ, spacings
  double outlier_scale_ = 0;                   // diagonals
  std::vector<BendingStencil> stencils_;       // of each node
  std::vector<double> bending_weights_;        // of each node
  std::vector<LocalSimilarity> similarities_;  // of each node: c and R
};

}  // namespace bespoke
