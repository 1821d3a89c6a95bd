#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <utility>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// An edge of a graph, as one of its ends sees it. Each end has its own similarity, so both are listed.
struct GraphEdge {
  int to = 0;
  Vector3 rest;       ///< from this end, mesh units
  double weight = 1;  ///< w, ≥ 0
};
using GraphEdges = std::vector<std::vector<GraphEdge>>;  // of each node

/// A weighted sum of nodes that is pulled to a target (a handle).
struct SoftConstraint {
  std::vector<std::pair<int, double>> shares;  ///< nodes i and aₖᵢ
  double weight = 0;                           ///< v, ≥ 0
};

/// As-similar-as-possible deformation of a graph (Igarashi 2005; Sorkine, Alexa 2007): places x' and
/// similarities M = scale × rotation of its nodes that minimise, in alternation,
///   κ Σᵢⱼ wᵢⱼ |x'ⱼ − x'ᵢ − Mᵢ eᵢⱼ|² + β Σᵢⱼ |Mᵢ − Mⱼ|² + Σₖ vₖ |Σᵢ aₖᵢ x'ᵢ − yₖ|²
/// over edges e at rest and soft constraints k. Not thread-safe.
class AsSimilarAsPossible {
 public:
  explicit AsSimilarAsPossible(GraphEdges edges);

  const GraphEdges& edges() const { return edges_; }
  /// M of each node; the identity at first.
  std::vector<Matrix3> similarities;

  /// The similarities of these places (3×n), node after node, with those of the neighbours as they are.
  /// smoothness: β.
  void fit_similarities(const Points& places, double smoothness = 0, int sweeps = 1);

  /// stiffness: κ. Throws SolverError where nothing determines a place.
  void set_constraints(std::vector<SoftConstraint> constraints, double stiffness);
  /// The places for these similarities. targets: 3×k, y of the constraints.
  Points places(const Points& targets) const;

 private:
  GraphEdges edges_;
  std::vector<SoftConstraint> constraints_;
  double stiffness_ = 1;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  bool analysed_ = false;  // constraints may change their weights, not their nodes
};

}  // namespace bespoke
