#include "bespoke/pattern/flattening/barrier_descent.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/error.h"
#include "bespoke/pattern/flattening/nearest_stretch.h"

namespace bespoke {
namespace {

constexpr int barrier_iterations = 60;

// Of the energy, what an iteration must lower it by.
constexpr double min_gain = 1e-5;

using SparseMatrix = Eigen::SparseMatrix<double>;

/// A face's weight, and the matrix that its Jacobian is drawn towards.
struct Proxy {
  double weight = 1;
  Eigen::Matrix2d target;
};

/// Of the same gradient as |J|² + |J⁻¹|², which is 2 s − 2 / s³ along a stretch s; det J > 0.
Proxy proxy_of(const Eigen::Matrix2d& jacobian) {
  // A matrix is the sum of a similarity and a mirrored one, of scales (s + t) / 2 and (s − t) / 2.
  const double e = (jacobian(0, 0) + jacobian(1, 1)) / 2, f = (jacobian(1, 0) - jacobian(0, 1)) / 2;
  Eigen::Matrix2d similar;
  similar << e, -f, f, e;
  const Eigen::Matrix2d mirrored = jacobian - similar;
  const double mean = std::hypot(e, f), half = std::hypot(mirrored(0, 0), mirrored(1, 0));
  const Eigen::Array2d s(mean + half, std::max(mean - half, jacobian.determinant() / (mean + half)));
  // (s − 1 / s³) / (s − 1), without the difference of the nearly equal.
  const double weight = ((s.cube() + s.square() + s + 1) / s.cube()).maxCoeff();
  const Eigen::Array2d target = s - (s - s.cube().inverse()) / weight;
  Proxy proxy{weight, similar * ((target[0] + target[1]) / 2 / mean)};
  if (half > 0) proxy.target += mirrored * ((target[0] - target[1]) / 2 / half);
  return proxy;
}

class Barrier {
 public:
  Barrier(const Piece& piece, const std::vector<RestFace>& rest) : piece_(piece), rest_(rest) {}

  double energy(const Eigen::Matrix2Xd& flat) const {
    double sum = 0;
    for (Eigen::Index f = 0; f < faces(); ++f) {
      const Eigen::Matrix2d j = jacobian(flat, f);
      const double determinant = j.determinant();
      if (!(determinant > 0)) return std::numeric_limits<double>::infinity();
      sum +=
          rest_[static_cast<std::size_t>(f)].area * j.squaredNorm() * (1 + 1 / (determinant * determinant));
    }
    return sum;
  }

  /// Minimum of the proxies, the first vertex held.
  Eigen::Matrix2Xd minimum(const Eigen::Matrix2Xd& flat) {
    const Eigen::Index n = flat.cols();
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::MatrixX2d right = Eigen::MatrixX2d::Zero(n - 1, 2);
    for (Eigen::Index f = 0; f < faces(); ++f) {
      const RestFace& rest = rest_[static_cast<std::size_t>(f)];
      const Proxy proxy = proxy_of(jacobian(flat, f));
      for (int i = 0; i < 3; ++i) {
        const int row = piece_.mesh.faces(i, f) - 1;
        if (row < 0) continue;
        const double scale = proxy.weight * rest.area;
        right.row(row) += scale * (proxy.target * rest.gradients.col(i)).transpose();
        for (int k = 0; k < 3; ++k) {
          const double value = scale * rest.gradients.col(i).dot(rest.gradients.col(k));
          const int column = piece_.mesh.faces(k, f) - 1;
          if (column < 0)
            right.row(row) -= value * flat.col(0).transpose();
          else
            entries.emplace_back(row, column, value);
        }
      }
    }
    SparseMatrix matrix(n - 1, n - 1);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (!is_analysed_) cholesky_.analyzePattern(matrix);
    is_analysed_ = true;
    cholesky_.factorize(matrix);
    if (cholesky_.info() != Eigen::Success)
      throw SolverError("piece '" + piece_.name + "': the system of its flattening cannot be factorised");
    Eigen::Matrix2Xd result(2, n);
    result.col(0) = flat.col(0);
    result.rightCols(n - 1) = cholesky_.solve(right).transpose();
    return result;
  }

  double unflipped(const Eigen::Matrix2Xd& flat, const Eigen::Matrix2Xd& step) const {
    constexpr double margin = 0.8;  // of the step to where a face would have no area
    double smallest = 1 / margin;
    for (Eigen::Index f = 0; f < faces(); ++f)
      smallest = std::min(smallest, unflipped_step(jacobian(flat, f), jacobian(step, f)));
    return margin * smallest;
  }

 private:
  Eigen::Index faces() const { return piece_.mesh.faces.cols(); }
  Eigen::Matrix2d jacobian(const Eigen::Matrix2Xd& flat, Eigen::Index face) const {
    return face_jacobian(rest_[static_cast<std::size_t>(face)], piece_.mesh.faces.col(face), flat);
  }

  const Piece& piece_;
  const std::vector<RestFace>& rest_;
  Eigen::SimplicialLLT<SparseMatrix> cholesky_;
  bool is_analysed_ = false;
};

}  // namespace

Eigen::Matrix2Xd barrier_descent(const Piece& piece, const std::vector<RestFace>& rest,
                                 Eigen::Matrix2Xd flat) {
  constexpr int halvings = 20;
  Barrier barrier(piece, rest);
  double energy = barrier.energy(flat);
  for (int k = 0; k < barrier_iterations; ++k) {
    const Eigen::Matrix2Xd step = barrier.minimum(flat) - flat;
    double length = barrier.unflipped(flat, step), next = energy;
    Eigen::Matrix2Xd moved = flat;
    for (int h = 0; h < halvings && !(next < energy); ++h, length /= 2) {
      moved = flat + length * step;
      next = barrier.energy(moved);
    }
    if (!(next < energy)) break;
    const double gain = energy - next;
    flat = std::move(moved);
    energy = next;
    if (gain < min_gain * energy) break;
  }
  return flat;
}

}  // namespace bespoke
