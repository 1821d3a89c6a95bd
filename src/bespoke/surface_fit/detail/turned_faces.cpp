#include "bespoke/surface_fit/detail/turned_faces.h"

#include <Eigen/LU>
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

/// What became of a surface, face by face.
class FaceChanges {
 public:
  FaceChanges(const TriangleMesh& before, const MendingSettings& settings)
      : before_(before),
        normals_(face_normals(before)),
        least_cosine_(std::cos(settings.most_degrees * std::numbers::pi / 180)),
        most_stretch_(settings.most_stretch) {}

  struct Bad {
    std::vector<Eigen::Index> turned, stretched;  // a face that turned is not called stretched as well
    bool empty() const { return turned.empty() && stretched.empty(); }
    std::vector<Eigen::Index> all() const {
      std::vector<Eigen::Index> faces = turned;
      faces.insert(faces.end(), stretched.begin(), stretched.end());
      return faces;
    }
  };

  /// A face without area has not turned.
  Bad bad(const Points& after) const {
    const Points normals = face_normals({after, before_.faces});
    Bad found;
    for (Eigen::Index face = 0; face < normals.cols(); ++face) {
      if (normals.col(face).squaredNorm() * normals_.col(face).squaredNorm() > 0 &&
          normals.col(face).dot(normals_.col(face)) < least_cosine_)
        found.turned.push_back(face);
      else if (stretch(after, face) > most_stretch_)
        found.stretched.push_back(face);
    }
    return found;
  }

 private:
  /// The larger of the largest factor by which a length in the face grew, and by which one shrank.
  double stretch(const Points& after, Eigen::Index face) const {
    const Matrix2 from = metric(before_.vertices, face), to = metric(after, face);
    if (!(from.determinant() > 0)) return 1;
    // Squared factors are the eigenvalues of from⁻¹ to.
    const Matrix2 squared = from.inverse() * to;
    const double half = squared.trace() / 2, product = squared.determinant();
    const double largest = half + std::sqrt(std::max(0.0, half * half - product));
    return std::sqrt(std::max(largest, largest / std::max(product, tiny)));
  }

  using Matrix2 = Eigen::Matrix2d;
  static constexpr double tiny = 1e-300;

  /// Products of the face's edges at its first corner.
  Matrix2 metric(const Points& vertices, Eigen::Index face) const {
    Eigen::Matrix<double, 3, 2> edges;
    for (int k = 0; k < 2; ++k)
      edges.col(k) = vertices.col(before_.faces(k + 1, face)) - vertices.col(before_.faces(0, face));
    return edges.transpose() * edges;
  }

  const TriangleMesh& before_;
  Points normals_;
  double least_cosine_, most_stretch_;
};

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

/// Each once, by index, and only those that were released.
void keep_released(const std::vector<char>& is_free, std::vector<int>& vertices) {
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  std::erase_if(vertices, [&](int vertex) { return !is_free[vertex]; });
}

}  // namespace

MendedSurface mend_turned_faces(const TriangleMesh& before, const Points& after,
                                const MendingSettings& settings) {
  const FaceChanges changes(before, settings);
  const VertexAdjacency adjacency = vertex_adjacency(before);
  Points mended = after;
  FaceChanges::Bad bad = changes.bad(after);
  MendedSurface result;
  for (const Eigen::Index face : bad.stretched)
    for (const int vertex : before.faces.col(face)) result.stretched_vertices.push_back(vertex);
  std::vector<char> is_free(static_cast<std::size_t>(after.cols()), 0);
  std::vector<int> free;
  const auto most_free = std::max(settings.released_at_least,
                                  static_cast<std::size_t>(settings.most_released * double(is_free.size())));
  for (int rings = 0; rings < settings.most_rings && !bad.empty(); ++rings) {
    std::vector<int> released;
    for (const int vertex : around(before, adjacency, bad.all(), rings))
      if (!is_free[vertex]) released.push_back(vertex);
    if (free.size() + released.size() > most_free) break;
    for (const int vertex : released) is_free[vertex] = 1;
    free.insert(free.end(), released.begin(), released.end());
    mended = before.vertices +
             spread_harmonically(before.vertices, adjacency, free, after - before.vertices, settings);
    bad = changes.bad(mended);
  }
  keep_released(is_free, result.stretched_vertices);
  result.vertices = std::move(mended);
  result.mended_vertices = free.size();
  result.turned_faces = bad.turned.size();
  return result;
}

}  // namespace bespoke
