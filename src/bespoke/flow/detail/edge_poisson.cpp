#include "bespoke/flow/detail/edge_poisson.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Cotangents of obtuse corners are negative, those of needles unbounded. Any positive weight keeps exact what
// can be met exactly, and the matrix definite.
constexpr double min_weight = 0.01;
constexpr double max_weight = 100;

/// Of the edge opposite corner k of a face with area.
double edge_weight(const Points& vertices, const Eigen::Vector3i& face, int k) {
  const Vector3 corner = vertices.col(face[k]);
  const Vector3 a = vertices.col(face[(k + 1) % 3]) - corner;
  const Vector3 b = vertices.col(face[(k + 2) % 3]) - corner;
  return std::clamp(a.dot(b) / a.cross(b).norm(), min_weight, max_weight);
}

}  // namespace

struct EdgePoisson::Factor {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky;
};

EdgePoisson::EdgePoisson(const TriangleMesh& source, const Eigen::VectorXd& areas,
                         const std::vector<int>& pinned)
    : source_(source), weights_(Eigen::Matrix3Xd::Zero(3, source.faces.cols())) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(12 * source.faces.cols()) + pinned.size());
  for (Eigen::Index face = 0; face < source.faces.cols(); ++face) {
    if (!(areas[face] > 0)) continue;
    for (int k = 0; k < 3; ++k) {
      const int i = source.faces((k + 1) % 3, face), j = source.faces((k + 2) % 3, face);
      const double weight = weights_(k, face) = edge_weight(source.vertices, source.faces.col(face), k);
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
      entries.emplace_back(i, j, -weight);
      entries.emplace_back(j, i, -weight);
    }
  }
  // The energy does not change when a piece is moved, so that this term can vanish, and does.
  for (const int vertex : pinned) entries.emplace_back(vertex, vertex, 1.0);
  Eigen::SparseMatrix<double> matrix(source.vertices.cols(), source.vertices.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  auto factor = std::make_unique<Factor>();
  factor->cholesky.compute(matrix);
  if (factor->cholesky.info() != Eigen::Success)
    throw SolverError("the surfaces between source and fitted source: the normal matrix of " +
                      std::to_string(source.vertices.cols()) + " vertices is not positive definite");
  factor_ = std::move(factor);
}

EdgePoisson::~EdgePoisson() = default;

/// Poisson's equation: the positions whose gradients are nearest to the interpolated ones, by area.
Points EdgePoisson::solve(const FaceRotations& rotations, double t) const {
  const auto count = static_cast<std::size_t>(source_.faces.cols());
  Points gradients(3, 3 * source_.faces.cols());
  parallel_for(count, faces_per_chunk, [&](std::size_t begin, std::size_t end) {
    for (auto face = static_cast<Eigen::Index>(begin); face < static_cast<Eigen::Index>(end); ++face)
      gradients.middleCols<3>(3 * face) = rotations.at(face, t);
  });
  Points right_side = Points::Zero(3, source_.vertices.cols());
  for (Eigen::Index face = 0; face < source_.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int i = source_.faces((k + 1) % 3, face), j = source_.faces((k + 2) % 3, face);
      const Vector3 edge = gradients.middleCols<3>(3 * face) *
                           (source_.vertices.col(i) - source_.vertices.col(j)) * weights_(k, face);
      right_side.col(i) += edge;
      right_side.col(j) -= edge;
    }
  const Eigen::MatrixXd solution = factor_->cholesky.solve(Eigen::MatrixXd(right_side.transpose()));
  return solution.transpose();
}

}  // namespace bespoke
