#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>
#include <cstdio>
#include <string>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/principal_widths.h"
#include "bespoke/rbf/front_cholesky.h"
#include "bespoke/rbf/kernels.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

void require_pairs(const Points& sources, const Points& targets) {
  if (sources.cols() != targets.cols())
    throw InvalidInput("csrbf: " + std::to_string(sources.cols()) + " sources and " +
                       std::to_string(targets.cols()) + " targets; the numbers must be equal");
  if (!targets.allFinite()) throw InvalidInput("csrbf: a target has a coordinate that is not finite");
}

std::string advice(const CsrbfEstimate& estimate) {
  char text[160];
  if (!(estimate.advised_lambda > 0))
    return "no effective distance fits: use fewer centres, or the elastic method multiscale";
  std::snprintf(text, sizeof text,
                "use an effective distance of at most %.3g, or the elastic method multiscale",
                estimate.advised_lambda);
  return text;
}

void require_within_limits(const CsrbfEstimate& estimate, const CsrbfOptions& options) {
  if (estimate.within_limits) return;
  char text[240];
  if (!(estimate.condition <= options.max_condition)) {
    std::snprintf(
        text, sizeof text,
        "csrbf: with effective distance %.4g and centres %.4g apart the system's condition is about %.1e, "
        "beyond %.1e; ",
        options.lambda, estimate.median_spacing, estimate.condition, options.max_condition);
    throw SolverError(text + advice(estimate));
  }
  constexpr double megabyte = 1 << 20;
  std::snprintf(
      text, sizeof text,
      "csrbf: effective distance %.4g gives %.0f entries a row and needs at least %.0f MB, more than %.0f "
      "MB; ",
      options.lambda, estimate.entries_per_row, double(estimate.bytes) / megabyte,
      double(options.max_memory) / megabyte);
  throw MemoryLimitError(text + advice(estimate));
}

/// Orthonormal columns that span the affine functions on the sources, and what they mean in space.
class AffineBasis {
 public:
  explicit AffineBasis(const Points& sources) : centre_(sources.rowwise().mean()) {
    const Points centred = sources.colwise() - centre_;
    require_spanning(centred);
    scale_ = centred.norm();
    Eigen::MatrixXd tail(sources.cols(), 4);
    tail << Eigen::VectorXd::Ones(sources.cols()), centred.transpose() / scale_;
    const Eigen::HouseholderQR<Eigen::MatrixXd> qr(tail);
    columns_ = qr.householderQ() * Eigen::MatrixXd::Identity(sources.cols(), 4);
    triangle_ = qr.matrixQR().topRows<4>().triangularView<Eigen::Upper>();
  }

  const Eigen::MatrixXd& columns() const { return columns_; }  // n×4

  /// The affine function with these coefficients (4×3) of the columns.
  AffineMap function(const Eigen::MatrixXd& coefficients) const {
    const Eigen::Matrix<double, 4, 3> tail =
        triangle_.triangularView<Eigen::Upper>().solve(Eigen::Matrix<double, 4, 3>(coefficients));
    AffineMap map;
    map.linear = tail.bottomRows<3>().transpose() / scale_;
    map.offset = tail.row(0).transpose() - map.linear * centre_;
    return map;
  }

 private:
  static void require_spanning(const Points& points) {
    // Of the largest width: across a thinner sheet the affine functions are made of rounding errors.
    constexpr double smallest_ratio = 1e-7;
    const auto [widths, directions] = principal_widths(points);
    if (widths[2] > smallest_ratio * widths[0]) return;
    const Vector3 missing = directions.col(2);
    char text[200];
    std::snprintf(
        text, sizeof text,
        "csrbf: the sources are coplanar: none leaves their plane along (%.4g, %.4g, %.4g); add sources off "
        "that plane",
        missing.x(), missing.y(), missing.z());
    throw InvalidInput(text);
  }

  Vector3 centre_;
  double scale_ = 1;
  Eigen::MatrixXd columns_;
  Eigen::Matrix4d triangle_;
};

struct Solution {
  Eigen::MatrixXd coefficients;  // n×3
  Eigen::MatrixXd affine;        // 4×3, in the orthonormal basis
};

/// Eq. 16 with its affine tail: [Φ Q; Qᵀ 0] [c; a] = [f; g] by the Schur complement Qᵀ Φ⁻¹ Q.
class TailedSystem {
 public:
  TailedSystem(const RadiusGraph& graph, const std::vector<double>& values, const FrontCholesky& factor,
               const Eigen::MatrixXd& basis)
      : graph_(graph), values_(values), factor_(factor), basis_(basis), solved_basis_(factor.solve(basis)) {
    schur_.compute(basis.transpose() * solved_basis_);
    if (schur_.info() != Eigen::Success) throw SolverError("csrbf: the affine part cannot be separated");
  }

  Solution solve(const Eigen::MatrixXd& f) const {
    Solution solution = solve_once(f, Eigen::MatrixXd::Zero(4, f.cols()));
    constexpr int refinements = 3;
    for (int pass = 0; pass < refinements; ++pass) {
      const Solution correction =
          solve_once(residual(solution, f), -basis_.transpose() * solution.coefficients);
      solution.coefficients += correction.coefficients;
      solution.affine += correction.affine;
    }
    return solution;
  }

  Eigen::MatrixXd residual(const Solution& solution, const Eigen::MatrixXd& f) const {
    Eigen::MatrixXd result = f - basis_ * solution.affine;
    parallel_for(std::size_t(f.rows()), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
        for (std::size_t entry = graph_.start[i]; entry < graph_.start[i + 1]; ++entry)
          sum += values_[entry] * solution.coefficients.row(graph_.neighbours[entry]);
        result.row(Eigen::Index(i)) -= sum;
      }
    });
    return result;
  }

 private:
  Solution solve_once(const Eigen::MatrixXd& f, const Eigen::MatrixXd& g) const {
    const Eigen::MatrixXd solved = factor_.solve(f);
    Solution solution;
    solution.affine = schur_.solve(basis_.transpose() * solved - g);
    solution.coefficients = solved - solved_basis_ * solution.affine;
    return solution;
  }

  const RadiusGraph& graph_;
  const std::vector<double>& values_;
  const FrontCholesky& factor_;
  const Eigen::MatrixXd& basis_;
  Eigen::MatrixXd solved_basis_;
  Eigen::LDLT<Eigen::MatrixXd> schur_;
};

}  // namespace

CsrbfFit fit_csrbf(const Points& sources, const Points& targets, const CsrbfOptions& options,
                   const Progress& progress) {
  const Stopwatch watch;
  require_pairs(sources, targets);
  CsrbfFit fit;
  fit.summary.estimate = estimate_csrbf(sources, options);
  require_within_limits(fit.summary.estimate, options);
  const AffineBasis basis(sources);
  progress.step("elastic", 0, 2);

  const RadiusGraph graph = radius_graph(sources, options.lambda);
  std::vector<double> values(graph.distances.size());
  parallel_for(values.size(), 1 << 14, [&](std::size_t first, std::size_t last) {
    for (std::size_t entry = first; entry < last; ++entry)
      values[entry] = WendlandC4::value(graph.distances[entry] / options.lambda);
  });
  const EliminationTree tree(sources, graph, options.lambda);
  const FrontCholesky factor(tree, graph, values, progress);
  progress.step("elastic", 1, 2);
  const TailedSystem system(graph, values, factor, basis.columns());
  const Eigen::MatrixXd displacements = (targets - sources).transpose();
  const Solution solution = system.solve(displacements);
  AffineMap affine = basis.function(solution.affine);
  affine.linear += Matrix3::Identity();
  fit.map = std::make_shared<CsrbfMap>(sources, solution.coefficients.transpose(), affine, options.lambda);
  fit.summary.residual = ((*fit.map)(sources)-targets).colwise().norm().maxCoeff();
  if (!std::isfinite(fit.summary.residual))
    throw SolverError("csrbf: the residual is not finite; " + advice(fit.summary.estimate));
  fit.summary.seconds = watch.seconds();
  progress.step("elastic", 2, 2);
  return fit;
}

}  // namespace bespoke
