#pragma once

#include <vector>

#include "bespoke/surface_fit/detail/block_system.h"
#include "bespoke/surface_fit/detail/boundary_match.h"
#include "bespoke/surface_fit/detail/deformation_nodes.h"
#include "bespoke/surface_fit/detail/plane_pairs.h"

namespace bespoke {

/// An anchor as the nodes see it.
struct NodeAnchor {
  SurfacePoint foot;     ///< the nearest point of the rest surface, which the anchor moves
  Vector3 displacement;  ///< from the anchor to its target, mesh units
  double weight = 0;     ///< infinite, or the percentage of the surface's area that a soft anchor counts like
};

/// What the nodes are to be solved for. Lengths in mesh units.
struct NodeGoals {
  const Points& vertices;  ///< 3×n, where the pairs were found
  const std::vector<PlanePair>& planes;
  const std::vector<BoundaryMatch>& boundary;
  double smoothing = 0;            ///< ℓ
  double exact_anchor_weight = 0;  ///< of all exact anchors together; the surface has 1
  /// k: the most that each anchor of infinite weight may pull (anchor_limits.h); empty: no limit.
  std::vector<double> anchor_limits = {};
  double rigidity = 1;  ///< g, ≥ 1: how much more than other pairs this one keeps its shape
};

/// The surface that the nodes deform.
struct NodeSurface {
  const TriangleMesh& rest;  ///< must outlive the system
  /// 3×n, aligned like `rest`: the shape to keep, which is that of `rest` unless a pose has bent it.
  const Points& shape;
  double area = 0;      ///< mesh units squared
  double diagonal = 0;  ///< mesh units
};

/// The normal equations of the displacements of the nodes of one level. Not thread-safe.
class NodeSystem {
 public:
  /// The settings must outlive the system.
  NodeSystem(const NodeSurface& surface, DeformationNodes nodes, const std::vector<NodeAnchor>& anchors,
             const NodeFitSettings& settings);

  /// Displacements that put the vertices (3×n) where a coarser level left them, weighted means around each
  /// node.
  void start_from(const Points& vertices);

  /// Minimises, with A the area, ℓ the smoothing length in spacings g of nodes, c = 1 / (1 + (r / (scale + ℓ
  /// gain))²) Cauchy's weight of the residual r before, s half-way to the median scale:
  ///   Σ_planes c w/A (n·(x − p))² + Σ_boundary w/A |x − p|² across the cut + Σ_anchors w |x − q'|²
  ///   + ℓ⁴/g² Σ_nodes (second differences)² + (g share ℓ)² Σ_nodes |edges − s R rest edges|².
  /// Returns where the vertices go, 3×n. Throws SolverError.
  Points solve(const NodeGoals& goals);

  /// Half of the nodes have edges that differ less from the turned and scaled ones of the shape: root mean
  /// square over the node, of the edges' length.
  double median_strain() const;

 private:
  /// An anchor's foot as a combination of nodes.
  struct Anchor {
    std::vector<NodeWeight> foot;
    Vector3 displacement;
    double weight;
  };
  /// The least-squares similarity about a node, without its translation.
  struct LocalSimilarity {
    Matrix3 rotation = Matrix3::Zero();
    double scale = 0;
  };
  struct LocalSimilarities {
    std::vector<LocalSimilarity> around;  // each node
    double usual_scale = 0;               // their median

    /// Of the node over the median one, within [1 / most, most].
    double growth(int node, double most) const;
  };

  std::vector<std::vector<int>> adjacency() const;
  template <class Nodes>
  void add_quadratic(const Nodes& combination, const Matrix3& form, const Vector3& goal_displacement);
  void add_planes(const NodeGoals& goals);
  void add_boundary(const std::vector<BoundaryMatch>& boundary);
  void add_anchors(const NodeGoals& goals);
  void add_bending(double weight, const LocalSimilarities& similarities);
  void add_local_similarity(double weight, const LocalSimilarities& similarities);
  Vector3 edge_now(int node, int other) const;
  Vector3 shape_edge(int node, int other) const;
  LocalSimilarity local_similarity(int node) const;
  LocalSimilarities local_similarities() const;
  Points moved_vertices() const;

  NodeSurface surface_;
  const NodeFitSettings& settings_;
  DeformationNodes nodes_;
  Points shape_;  // 3×k, of the nodes
  std::vector<Anchor> anchors_;
  BlockSystem system_;
  Points displacements_;
};

}  // namespace bespoke
