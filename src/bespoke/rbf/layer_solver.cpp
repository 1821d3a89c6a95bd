#include "bespoke/rbf/layer_solver.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/conjugate_gradients.h"
#include "bespoke/rbf/elimination_tree.h"
#include "bespoke/rbf/kernels.h"

namespace bespoke {
namespace {

constexpr std::size_t grain = 1024;

/// The kernel matrix of a layer, by a function of Wendland (1995; kernels.h), plus a ridge; the diagonal
/// entries are among those of the graph. `solved` ends the conjugate gradients.
template <class Kernel, class Solved>
class KernelSystem {
 public:
  KernelSystem(const Points& centers, double lambda, double ridge, const Solved& solved)
      : graph_(radius_graph(centers, lambda)), ridge_(ridge), solved_(solved) {
    values_.resize(graph_.distances.size());
    parallel_for(values_.size(), 16 * grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t entry = begin; entry < end; ++entry)
        values_[entry] = Kernel::value(graph_.distances[entry] / lambda);
    });
  }

  Points multiply(const Points& x) const {
    Points result(3, x.cols());
    parallel_for(std::size_t(x.cols()), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vector3 sum = ridge_ * x.col(Eigen::Index(i));
        for (std::size_t entry = graph_.start[i]; entry < graph_.start[i + 1]; ++entry)
          sum += values_[entry] * x.col(graph_.neighbours[entry]);
        result.col(Eigen::Index(i)) = sum;
      }
    });
    return result;
  }

  const Points& precondition(const Points& residual) const { return residual; }

  Vector3 products(const Points& a, const Points& b) const {
    const auto partial = [&](std::size_t begin, std::size_t end) -> Vector3 {
      Vector3 sum = Vector3::Zero();
      for (auto i = Eigen::Index(begin); i < Eigen::Index(end); ++i) sum += a.col(i).cwiseProduct(b.col(i));
      return sum;
    };
    return parallel_reduce(std::size_t(a.cols()), grain, Vector3(Vector3::Zero()), partial,
                           [](const Vector3& x, const Vector3& y) -> Vector3 { return x + y; });
  }

  bool solved(const Points& residual, const Vector3& squared, int steps) const {
    return solved_(residual, squared, steps);
  }

 private:
  RadiusGraph graph_;
  double ridge_;
  Solved solved_;
  std::vector<double> values_;
};

template <class Kernel, class Solved>
Points coefficients(const Points& centers, const Points& values, double lambda, double ridge,
                    const Solved& solved) {
  const KernelSystem<Kernel, Solved> system(centers, lambda, ridge, solved);
  Points result = Points::Zero(3, centers.cols());
  conjugate_gradients(system, result, values);
  return result;
}

}  // namespace

RbfLayer solve_layer(const Points& centers, const Points& values, double lambda, double tolerance) {
  constexpr double relative_tolerance = 1e-3;  // of the largest value
  const double max_residual = std::max(tolerance, relative_tolerance * values.colwise().norm().maxCoeff());
  const auto solved = [max_residual](const Points& residual, const Vector3&, int steps) {
    // Far more than spacing λ/4 needs; a system that requires more is not the one promised.
    constexpr int max_steps = 1000;
    const double left = residual.colwise().norm().maxCoeff();
    if (left <= max_residual) return true;
    if (steps < max_steps && std::isfinite(left)) return false;
    throw SolverError("radial layer of " + std::to_string(residual.cols()) + " centres: residual " +
                      std::to_string(left) + " after " + std::to_string(steps) +
                      " conjugate gradient iterations");
  };
  return {lambda, centers, coefficients<WendlandC2>(centers, values, lambda, 0, solved)};
}

Points smooth_layer(const Points& centers, const Points& values, double lambda,
                    const SmoothLayerOptions& options) {
  const Vector3 enough = options.residual * values.rowwise().squaredNorm();
  return coefficients<WendlandC4>(
      centers, values, lambda, options.ridge, [&](const Points&, const Vector3& squared, int steps) {
        return steps == options.max_steps || (squared.array() <= enough.array()).all();
      });
}

}  // namespace bespoke
