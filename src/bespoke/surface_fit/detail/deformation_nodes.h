#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A few points of a surface that carry its deformation. Every vertex follows the nodes near it along the
/// surface, with weights that sum to 1 and reproduce linear displacements along the surface.
struct DeformationNodes {
  static constexpr int per_vertex = 8;

  double spacing = 0;                        ///< mesh units, along the surface
  Points rest;                               ///< 3×k, mesh units
  Eigen::VectorXd areas;                     ///< k: area of the vertices nearest to each node; sum 1
  std::vector<std::vector<int>> neighbours;  ///< k; linked across components as well
  Eigen::MatrixXi vertex_nodes;              ///< per_vertex×n
  Eigen::MatrixXd vertex_weights;            ///< per_vertex×n; 0 where a vertex has fewer nodes

  int size() const { return static_cast<int>(rest.cols()); }

  /// Displacement of a vertex from those of the nodes (3×k).
  Vector3 displacement(const Points& node_displacements, Eigen::Index vertex) const;
};

/// Nodes no closer than `spacing` (> 0, mesh units) along the edges of `mesh`, every vertex within `spacing`
/// of one. Components of less area than a node's share get no node and follow the nearest ones in space; if
/// that is most of the surface (a polygon soup), distance in space is used throughout.
DeformationNodes make_deformation_nodes(const TriangleMesh& mesh, double spacing);

/// The energy of displacements of `ids` that no affine map explains: Σ quadratic(a, b) dₐ·d_b, mesh units
/// squared; next to zero for affine displacements.
struct BendingStencil {
  std::vector<int> ids;
  Eigen::MatrixXd quadratic;
};

/// One per node: the node and its neighbours, which are now at `places` (3×k, mesh units).
std::vector<BendingStencil> bending_stencils(const DeformationNodes& nodes, const Points& places);

}  // namespace bespoke
