#include "bespoke/surface_fit/detail/turned_faces.h"

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // n×3, the layout of the solver

/// Faces whose normals are farther apart; a face without area has not turned.
std::vector<Eigen::Index> turned_faces(const Points& before_normals, const TriangleMesh& after,
                                       double least_cosine) {
  const Points normals = face_normals(after);
  std::vector<Eigen::Index> turned;
  for (Eigen::Index face = 0; face < normals.cols(); ++face)
    if (normals.col(face).squaredNorm() * before_normals.col(face).squaredNorm() > 0 &&
        normals.col(face).dot(before_normals.col(face)) < least_cosine)
      turned.push_back(face);
  return turned;
}

/// The displacements (3×n) with those of the free vertices replaced by the mean of their neighbours',
/// weighted by inverse length, so that displacements change as fast across short edges as across long ones.
Points spread_harmonically(const Points& places, const VertexAdjacency& adjacency,
                           const std::vector<int>& free, Points displacements,
                           const MendingSettings& settings) {
  constexpr int fixed = -1;
  const double least_length = settings.shortest * diagonal(places);
  std::vector<int> row_of(static_cast<std::size_t>(displacements.cols()), fixed);
  for (std::size_t k = 0; k < free.size(); ++k) row_of[free[k]] = static_cast<int>(k);
  const auto count = static_cast<int>(free.size());
  std::vector<Eigen::Triplet<double>> entries;
  Columns right = Columns::Zero(count, 3);
  for (int row = 0; row < count; ++row) {
    const int vertex = free[row];
    double total = 0;
    for (int k = adjacency.start[vertex]; k < adjacency.start[vertex + 1]; ++k) {
      const int other = adjacency.neighbours[k];
      const double length = (places.col(other) - places.col(vertex)).norm();
      const double weight = least_length / std::max(length, least_length);
      total += weight;
      if (row_of[other] == fixed)
        right.row(row) += weight * displacements.col(other).transpose();
      else
        entries.emplace_back(row, row_of[other], -weight);
    }
    const double keep = settings.keep * total;
    right.row(row) += keep * displacements.col(vertex).transpose();
    entries.emplace_back(row, row, total + keep);
  }
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  if (factor.info() != Eigen::Success)
    throw SolverError("the displacements of " + std::to_string(count) + " vertices could not be spread");
  const Columns solution = factor.solve(right);
  for (int row = 0; row < count; ++row) displacements.col(free[row]) = solution.row(row).transpose();
  return displacements;
}

/// The faces' corners and the vertices at most `rings` edges away from one.
std::vector<int> around(const TriangleMesh& mesh, const VertexAdjacency& adjacency,
                        const std::vector<Eigen::Index>& faces, int rings) {
  std::vector<int> patch;
  std::vector<char> in_patch(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  const auto add = [&](int vertex) {
    if (!std::exchange(in_patch[vertex], 1)) patch.push_back(vertex);
  };
  for (const Eigen::Index face : faces)
    for (const int vertex : mesh.faces.col(face)) add(vertex);
  std::size_t begin = 0;
  for (int ring = 0; ring < rings; ++ring)
    for (const std::size_t end = patch.size(); begin < end; ++begin)
      for (int k = adjacency.start[patch[begin]]; k < adjacency.start[patch[begin] + 1]; ++k)
        add(adjacency.neighbours[k]);
  return patch;
}

}  // namespace

MendedSurface mend_turned_faces(const TriangleMesh& before, const Points& after,
                                const MendingSettings& settings) {
  const double least_cosine = std::cos(settings.most_degrees * std::numbers::pi / 180);
  const Points before_normals = face_normals(before);
  const VertexAdjacency adjacency = vertex_adjacency(before);
  TriangleMesh mended{after, before.faces};
  std::vector<Eigen::Index> turned = turned_faces(before_normals, mended, least_cosine);
  std::vector<char> is_free(static_cast<std::size_t>(after.cols()), 0);
  std::vector<int> free;
  const auto most_free = std::max(settings.released_at_least,
                                  static_cast<std::size_t>(settings.most_released * double(is_free.size())));
  for (int rings = 0; rings < settings.most_rings && !turned.empty(); ++rings) {
    std::vector<int> released;
    for (const int vertex : around(before, adjacency, turned, rings))
      if (!is_free[vertex]) released.push_back(vertex);
    if (free.size() + released.size() > most_free) break;
    for (const int vertex : released) is_free[vertex] = 1;
    free.insert(free.end(), released.begin(), released.end());
    mended.vertices = before.vertices + spread_harmonically(before.vertices, adjacency, free,
                                                            after - before.vertices, settings);
    turned = turned_faces(before_normals, mended, least_cosine);
  }
  return {std::move(mended.vertices), free.size(), turned.size()};
}

}  // namespace bespoke
