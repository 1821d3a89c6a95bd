#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/surface_fit/deformation_graph_settings.h"

namespace bespoke {

/// A node and its weight.
struct NodeWeight {
  int node = 0;
  double weight = 0;
};

/// A vertex as a weighted sum of nodes; without allocation, because every pair evaluates it.
struct VertexNodes {
  std::array<NodeWeight, NodeSettings::per_vertex> nodes;
  std::size_t count = 0;

  const NodeWeight* begin() const { return nodes.data(); }
  const NodeWeight* end() const { return nodes.data() + count; }
};

/// A few points of a surface that carry its deformation. Every vertex follows the nodes near it along the
/// surface, with weights that sum to 1 and reproduce linear displacements along the surface.
struct DeformationNodes {
  static constexpr int per_vertex = NodeSettings::per_vertex;

  double spacing = 0;                        ///< mesh units, along the surface
  std::vector<int> vertices;                 ///< k: where each node stands
  Points rest;                               ///< 3×k, mesh units
  Eigen::VectorXd areas;                     ///< k: area of the vertices nearest to each node; sum 1
  std::vector<std::vector<int>> neighbours;  ///< k; linked across components as well
  Eigen::MatrixXi vertex_nodes;              ///< per_vertex×n
  Eigen::MatrixXd vertex_weights;            ///< per_vertex×n; 0 where a vertex has fewer nodes

  int size() const { return static_cast<int>(rest.cols()); }

  /// The nodes that a vertex follows.
  VertexNodes at_vertex(int vertex) const;

  /// The nodes that a point of the surface follows, in increasing order; faces: of the mesh they were made
  /// for.
  std::vector<NodeWeight> at_point(const SurfacePoint& point, const Faces& faces) const;

  /// Displacement of a vertex from those of the nodes (3×k).
  Vector3 displacement(const Points& node_displacements, Eigen::Index vertex) const;
};

/// The spacing at which a surface of `area` (mesh units squared) gets about `count` nodes, mesh units.
double node_spacing(double area, int count, const NodeSettings& settings = {});

/// Nodes no closer than `spacing` (> 0, mesh units) along the edges of `mesh`, every vertex within `spacing`
/// of one. Components of less area than a node's share get no node and follow the nearest ones in space; if
/// that is most of the surface (a polygon soup), distance in space is used throughout.
DeformationNodes make_deformation_nodes(const TriangleMesh& mesh, double spacing,
                                        const NodeSettings& settings = {});

/// The energy of displacements of `ids` that no affine map explains: Σ quadratic(a, b) dₐ·d_b, mesh units
/// squared; next to zero for affine displacements.
struct BendingStencil {
  std::vector<int> ids;
  Eigen::MatrixXd quadratic;
};

/// One per node: the node and its neighbours, which are now at `places` (3×k, mesh units).
std::vector<BendingStencil> bending_stencils(const DeformationNodes& nodes, const Points& places,
                                             const BendingSettings& settings = {});

}  // namespace bespoke
