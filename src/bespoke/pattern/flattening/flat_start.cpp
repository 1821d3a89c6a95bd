#include "bespoke/pattern/flattening/flat_start.h"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <numbers>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/pattern/self_overlap.h"

namespace bespoke {
namespace {

using Sparse = Eigen::SparseMatrix<double>;
using Cholesky = Eigen::SimplicialLLT<Sparse>;

double total_area(const std::vector<RestFace>& rest) {
  double area = 0;
  for (const RestFace& face : rest) area += face.area;
  return area;
}

/// Scaled so that the faces have the surface's area.
Eigen::Matrix2Xd of_area(const Piece& piece, const std::vector<RestFace>& rest, Eigen::Matrix2Xd flat) {
  double area = 0;
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
    const RestFace& face = rest[static_cast<std::size_t>(f)];
    area += face.area * face_jacobian(face, piece.mesh.faces.col(f), flat).determinant();
  }
  return flat * std::sqrt(total_area(rest) / area);
}

/// Two vertices of the outline, far apart: from any one the farthest, and from there the farthest.
std::pair<int, int> far_ends(const Piece& piece) {
  const auto farthest = [&](int from) {
    int best = from;
    double best_distance = -1;
    for (const int v : piece.outline) {
      const double distance = (piece.mesh.vertices.col(v) - piece.mesh.vertices.col(from)).squaredNorm();
      if (distance > best_distance) best = v, best_distance = distance;
    }
    return best;
  };
  const int first = farthest(piece.outline.front());
  return {first, farthest(first)};
}

/// Rows of unknowns: where each vertex's unknown stands, `fixed` for those that have none.
constexpr int fixed = -1;

/// Solves matrix x = 0 for the unknowns, the others being given: d×n.
Eigen::MatrixXd solved(const Sparse& matrix, const std::vector<int>& unknown, Eigen::Index count,
                       Eigen::MatrixXd values) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(count, values.cols());
  for (int column = 0; column < matrix.outerSize(); ++column)
    for (Sparse::InnerIterator entry(matrix, column); entry; ++entry) {
      const int i = unknown[static_cast<std::size_t>(entry.row())];
      const int j = unknown[static_cast<std::size_t>(column)];
      if (i == fixed) continue;
      if (j == fixed)
        right.row(i) -= entry.value() * values.row(column);
      else
        entries.emplace_back(i, j, entry.value());
    }
  Sparse reduced(count, count);
  reduced.setFromTriplets(entries.begin(), entries.end());
  const Cholesky cholesky(reduced);
  if (cholesky.info() != Eigen::Success) return {};
  const Eigen::MatrixXd x = cholesky.solve(right);
  for (std::size_t v = 0; v < unknown.size(); ++v)
    if (unknown[v] != fixed) values.row(static_cast<Eigen::Index>(v)) = x.row(unknown[v]);
  return values;
}

/// Energy of (u, v): the Dirichlet energies minus the area, which is a sum over the outline.
Sparse conformal_matrix(const Piece& piece, const std::vector<RestFace>& rest) {
  const Sparse laplacian = stiffness(piece.mesh, rest);
  const auto n = static_cast<int>(laplacian.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < n; ++column)
    for (Sparse::InnerIterator entry(laplacian, column); entry; ++entry) {
      entries.emplace_back(static_cast<int>(entry.row()), column, entry.value());
      entries.emplace_back(n + static_cast<int>(entry.row()), n + column, entry.value());
    }
  for (std::size_t k = 0; k < piece.outline.size(); ++k) {
    const int i = piece.outline[k], j = piece.outline[(k + 1) % piece.outline.size()];
    // Minus the area's second derivatives: twice the area is the sum of u_i v_j − u_j v_i.
    for (const auto& [u, v, sign] : {std::tuple(i, j, -0.5), std::tuple(j, i, 0.5)}) {
      entries.emplace_back(u, n + v, sign);
      entries.emplace_back(n + v, u, sign);
    }
  }
  Sparse matrix(2 * n, 2 * n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

std::optional<Eigen::Matrix2Xd> conformal_start(const Piece& piece, const std::vector<RestFace>& rest) {
  const Eigen::Index n = piece.mesh.vertices.cols();
  const auto [a, b] = far_ends(piece);
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(2 * n, 1);
  values(b) = (piece.mesh.vertices.col(b) - piece.mesh.vertices.col(a)).norm();
  std::vector<int> unknown(static_cast<std::size_t>(2 * n), fixed);
  int count = 0;
  for (Eigen::Index i = 0; i < 2 * n; ++i)
    if (i % n != a && i % n != b) unknown[static_cast<std::size_t>(i)] = count++;
  const Eigen::MatrixXd x = solved(conformal_matrix(piece, rest), unknown, count, std::move(values));
  if (x.size() == 0) return {};
  Eigen::Matrix2Xd flat(2, n);
  flat.row(0) = x.topRows(n).transpose();
  flat.row(1) = x.bottomRows(n).transpose();
  if (!flat.allFinite() || !is_unflipped(piece.mesh, rest, flat)) return {};
  if (outline_crossing(flat, piece.outline)) return {};
  return of_area(piece, rest, std::move(flat));
}

Eigen::Matrix2Xd tutte_start(const Piece& piece, const std::vector<RestFace>& rest) {
  const Eigen::Index n = piece.mesh.vertices.cols();
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(n, 2);
  std::vector<double> along{0};
  for (std::size_t k = 0; k < piece.outline.size(); ++k)
    along.push_back(along.back() + (piece.mesh.vertices.col(piece.outline[(k + 1) % piece.outline.size()]) -
                                    piece.mesh.vertices.col(piece.outline[k]))
                                       .norm());
  std::vector<int> unknown(static_cast<std::size_t>(n), 0);
  for (std::size_t k = 0; k < piece.outline.size(); ++k) {
    const double angle = 2 * std::numbers::pi * along[k] / along.back();
    values.row(piece.outline[k]) << std::cos(angle), std::sin(angle);
    unknown[static_cast<std::size_t>(piece.outline[k])] = fixed;
  }
  int count = 0;
  for (int& place : unknown)
    if (place != fixed) place = count++;
  std::vector<Eigen::Triplet<double>> entries;
  const VertexAdjacency adjacency = vertex_adjacency(piece.mesh);
  for (int v = 0; v < static_cast<int>(n); ++v) {
    const int begin = adjacency.start[static_cast<std::size_t>(v)];
    const int end = adjacency.start[static_cast<std::size_t>(v) + 1];
    entries.emplace_back(v, v, end - begin);
    for (int k = begin; k < end; ++k)
      entries.emplace_back(v, adjacency.neighbours[static_cast<std::size_t>(k)], -1.0);
  }
  Sparse matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::MatrixXd x = solved(matrix, unknown, count, std::move(values));
  const Eigen::Matrix2Xd flat =
      x.size() == 0 ? Eigen::Matrix2Xd::Zero(2, n) : Eigen::Matrix2Xd(x.transpose());
  if (!is_unflipped(piece.mesh, rest, flat))
    throw SolverError("piece '" + piece.name +
                      "' cannot be embedded in the plane without flipped faces: it has " +
                      "faces far thinner than doubles resolve; remesh it");
  return of_area(piece, rest, flat);
}

}  // namespace bespoke
