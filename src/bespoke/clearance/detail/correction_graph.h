#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// Vertices in no part that keeps its shape have this number.
inline constexpr int no_part = -1;

/// What of a product moves by itself, and what goes with it.
struct CorrectionGraph {
  /// n×m, rows sum to 1: a vertex's displacement from those of the nodes. A node is a place of the product
  /// (vertices at one position share it) or a part that keeps its shape. Vertices of a shell that lies on a
  /// larger one everywhere (a button, a pocket) go with the three nodes below them.
  Eigen::SparseMatrix<double, Eigen::RowMajor> vertex_from_node;
  /// m×m, symmetric, without diagonal: weights of the edges between nodes, and of ties between shells that
  /// lie near each other and between the two sheets of a thick one.
  Eigen::SparseMatrix<double> weights;
  /// m: 1 where ties join the node to others.
  std::vector<char> is_tied;
  /// m: 1 for parts that keep their shape.
  std::vector<char> is_part;

  int nodes() const { return static_cast<int>(weights.cols()); }
};

/// `part_of_vertex`: n numbers of parts or no_part, or empty. `lines`: 2×k further edges.
CorrectionGraph correction_graph(const TriangleMesh& product, const Eigen::Matrix2Xi& lines,
                                 const std::vector<int>& part_of_vertex);

}  // namespace bespoke
