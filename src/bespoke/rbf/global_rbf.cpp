#include "bespoke/rbf/global_rbf.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <string>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/principal_widths.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

double cubed_distance(const Vector3& a, const Vector3& b) {
  const double squared = (a - b).squaredNorm();
  return squared * std::sqrt(squared);
}

void require_pairs(const Points& sources, const Points& targets, const Eigen::VectorXd& weights) {
  if (sources.cols() != targets.cols() || sources.cols() != weights.size())
    throw InvalidInput("coarse warp: " + std::to_string(sources.cols()) + " source points, " +
                       std::to_string(targets.cols()) + " target points and " +
                       std::to_string(weights.size()) + " weights; the three numbers must be equal");
  if (sources.cols() < 4)
    throw InvalidInput("the coarse warp needs 4 anchor pairs; there are " + std::to_string(sources.cols()));
  for (Eigen::Index i = 0; i < sources.cols(); ++i) {
    if (!sources.col(i).allFinite() || !targets.col(i).allFinite())
      throw InvalidInput("coarse warp: anchor pair " + std::to_string(i) +
                         " has a coordinate that is not finite");
    if (!(weights[i] > 0))
      throw InvalidInput("coarse warp: weight " + std::to_string(weights[i]) + " of anchor pair " +
                         std::to_string(i) + " must be positive");
  }
}

void require_spanning(const Points& points) {
  // Thinner than this, the affine part across the sheet has no correct digits to interpolate with.
  constexpr double smallest_ratio = 1e-6;
  const auto [widths, directions] = principal_widths(points);
  if (widths[2] > smallest_ratio * widths[0]) return;
  const Vector3 missing = directions.col(2);
  char text[240];
  std::snprintf(
      text, sizeof text,
      "coarse warp: the %td anchor points on the source are coplanar: none leaves their plane along "
      "(%.4g, %.4g, %.4g); add an anchor off that plane, or the corners of the bounding boxes",
      static_cast<std::ptrdiff_t>(points.cols()), missing.x(), missing.y(), missing.z());
  throw InvalidInput(text);
}

void require_distinct(const Points& sources, double scale) {
  // Closer pairs leave their difference quotient to rounding errors.
  const double smallest_distance = 1e-9 * scale;
  const PointGrid grid(sources, scale / 64);
  for (int i = 0; i < sources.cols(); ++i)
    grid.for_each_within(sources.col(i), smallest_distance, [&](int j, double) {
      if (j == i) return;
      throw InvalidInput("coarse warp: anchor pairs " + std::to_string(std::min(i, j)) + " and " +
                         std::to_string(std::max(i, j)) + " have the same place on the source; remove one");
    });
}

/// Coordinates with centre 0 and bounding-box diagonal 1, so that no number below depends on the unit.
struct Normalisation {
  Vector3 centre;
  double scale;
  explicit Normalisation(const Points& points)
      : centre((points.rowwise().maxCoeff() + points.rowwise().minCoeff()) / 2),
        scale((points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm()) {}
};

struct Solution {
  Eigen::MatrixX3d coefficients;
  Eigen::Matrix<double, 4, 3> affine;
};

/// Eq. 7–10, a polyharmonic spline (Duchon 1977) over c ⊥ tail: [K P; Pᵀ 0] [c; a] = [f; 0].
class NullSpaceSolver {
 public:
  NullSpaceSolver(Eigen::MatrixXd kernel, const Eigen::MatrixX4d& tail)
      : kernel_(std::move(kernel)), tail_(tail), qr_(tail) {
    // Two-sided: Qᵀ K Q, whose lower right block is Zᵀ K Z for the basis Z of the tail's null space.
    Eigen::MatrixXd rotated = qr_.householderQ().transpose() * kernel_;
    rotated = (rotated * qr_.householderQ()).eval();
    const Eigen::Index free = tail.rows() - 4;
    reduced_.compute(rotated.bottomRightCorner(free, free));
    if (reduced_.info() != Eigen::Success)
      throw SolverError("coarse warp: the system of " + std::to_string(tail.rows()) +
                        " anchors is not definite to working precision; anchors lie too close together");
  }

  Solution solve(const Eigen::MatrixX3d& values) const {
    Solution solution = solve_once(values);
    // The cubes of distances spread over many decades; two corrections restore the last digits.
    for (int pass = 0; pass < 2; ++pass) {
      const Solution correction =
          solve_once(values - kernel_ * solution.coefficients - tail_ * solution.affine);
      solution.coefficients += correction.coefficients;
      solution.affine += correction.affine;
    }
    return solution;
  }

  double residual(const Solution& solution, const Eigen::MatrixX3d& values) const {
    return (values - kernel_ * solution.coefficients - tail_ * solution.affine).rowwise().norm().maxCoeff();
  }

 private:
  Solution solve_once(const Eigen::MatrixX3d& values) const {
    const Eigen::Index free = tail_.rows() - 4;
    Eigen::MatrixX3d rotated = qr_.householderQ().transpose() * values;
    Eigen::MatrixX3d coefficients = Eigen::MatrixX3d::Zero(tail_.rows(), 3);
    coefficients.bottomRows(free) = reduced_.solve(rotated.bottomRows(free));
    coefficients = (qr_.householderQ() * coefficients).eval();
    rotated -= qr_.householderQ().transpose() * (kernel_ * coefficients);
    const Eigen::Matrix<double, 4, 3> affine =
        qr_.matrixQR().topRows<4>().triangularView<Eigen::Upper>().solve(rotated.topRows<4>());
    return {coefficients, affine};
  }

  Eigen::MatrixXd kernel_;
  Eigen::MatrixX4d tail_;
  Eigen::HouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::LLT<Eigen::MatrixXd> reduced_;
};

}  // namespace

GlobalRbf::GlobalRbf(const Points& sources, const Points& targets, const Eigen::VectorXd& weights) {
  require_pairs(sources, targets, weights);
  const Normalisation unit(sources);
  const Points centred = sources.colwise() - unit.centre;
  require_spanning(sources);
  require_distinct(sources, unit.scale);

  const Eigen::Index n = sources.cols();
  const Points x = centred / unit.scale;
  Eigen::MatrixXd kernel(n, n);
  for (Eigen::Index j = 0; j < n; ++j)
    for (Eigen::Index i = 0; i < n; ++i) kernel(i, j) = cubed_distance(x.col(i), x.col(j));
  kernel.diagonal() += weights.cwiseInverse();
  Eigen::MatrixX4d tail(n, 4);
  tail << Eigen::VectorXd::Ones(n), x.transpose();

  // Displacements, so that the rounding error scales with the warp and not with the place of the origin.
  const Eigen::MatrixX3d values = (targets - sources).transpose();
  const NullSpaceSolver solver(kernel, tail);
  const Solution solution = solver.solve(values);
  const double residual = solver.residual(solution, values);
  constexpr double largest_residual = 1e-9;  // of the diagonal
  if (!(residual <= largest_residual * unit.scale)) {
    char text[160];
    std::snprintf(text, sizeof text,
                  "coarse warp: residual %.3g of the equations exceeds %.3g; anchors lie too close together",
                  residual, largest_residual * unit.scale);
    throw SolverError(text);
  }
  const double cube = unit.scale * unit.scale * unit.scale;
  centers_ = sources;
  coefficients_ = solution.coefficients.transpose() / cube;
  affine_.linear = Matrix3::Identity() + solution.affine.bottomRows<3>().transpose() / unit.scale;
  affine_.offset = unit.centre + solution.affine.row(0).transpose() - affine_.linear * unit.centre;
}

Points GlobalRbf::operator()(const Points& x) const {
  Points result = affine_ * x;
  constexpr std::size_t grain = 256;
  parallel_for(static_cast<std::size_t>(x.cols()), grain, [&](std::size_t begin, std::size_t end) {
    for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
      Vector3 sum = Vector3::Zero();
      for (Eigen::Index j = 0; j < centers_.cols(); ++j)
        sum += coefficients_.col(j) * cubed_distance(x.col(i), centers_.col(j));
      result.col(i) += sum;
    }
  });
  return result;
}

}  // namespace bespoke
