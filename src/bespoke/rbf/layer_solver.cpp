#include "bespoke/rbf/layer_solver.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/elimination_tree.h"
#include "bespoke/rbf/kernels.h"

namespace bespoke {
namespace {

constexpr std::size_t grain = 1024;

/// The kernel matrix without its unit diagonal.
class KernelMatrix {
 public:
  KernelMatrix(const Points& centers, double lambda) : graph_(radius_graph(centers, lambda)) {
    values_.resize(graph_.distances.size());
    parallel_for(values_.size(), 16 * grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t entry = begin; entry < end; ++entry)
        values_[entry] = WendlandC2::value(graph_.distances[entry] / lambda);
    });
  }

  Points operator*(const Points& x) const {
    Points result(3, x.cols());
    parallel_for(std::size_t(x.cols()), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vector3 sum = Vector3::Zero();
        for (std::size_t entry = graph_.start[i]; entry < graph_.start[i + 1]; ++entry)
          sum += values_[entry] * x.col(graph_.neighbours[entry]);
        result.col(Eigen::Index(i)) = sum;
      }
    });
    return result;
  }

 private:
  RadiusGraph graph_;
  std::vector<double> values_;
};

/// One scalar product for each coordinate.
Eigen::Array3d products(const Points& a, const Points& b) {
  const auto partial = [&](std::size_t begin, std::size_t end) -> Eigen::Array3d {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (auto i = Eigen::Index(begin); i < Eigen::Index(end); ++i) sum += a.col(i).array() * b.col(i).array();
    return sum;
  };
  return parallel_reduce(
      std::size_t(a.cols()), grain, Eigen::Array3d(Eigen::Array3d::Zero()), partial,
      [](const Eigen::Array3d& x, const Eigen::Array3d& y) -> Eigen::Array3d { return x + y; });
}

}  // namespace

RbfLayer solve_layer(const Points& centers, const Points& values, double lambda, double tolerance) {
  const KernelMatrix matrix(centers, lambda);
  const double largest = values.colwise().norm().maxCoeff();
  const double stop = std::max(tolerance, 1e-3 * largest);
  Points coefficients = Points::Zero(3, centers.cols());
  Points residual = values;
  Points direction = residual;
  Eigen::Array3d squared = products(residual, residual);
  // Far more than spacing λ/4 needs; a system that wants more is not the one promised.
  constexpr int most_iterations = 1000;
  for (int iteration = 0;; ++iteration) {
    const double left = residual.colwise().norm().maxCoeff();
    if (left <= stop) return {lambda, centers, std::move(coefficients)};
    if (!(iteration < most_iterations) || !std::isfinite(left))
      throw SolverError("radial layer of " + std::to_string(centers.cols()) + " centres: residual " +
                        std::to_string(left) + " after " + std::to_string(iteration) +
                        " conjugate gradient iterations");
    const Points image = matrix * direction;
    const auto ratio = [](const Eigen::Array3d& a, const Eigen::Array3d& b) -> Vector3 {
      return (b > 0).select(a / b, 0).matrix();
    };
    const Vector3 step = ratio(squared, products(direction, image));
    coefficients += step.asDiagonal() * direction;
    residual -= step.asDiagonal() * image;
    const Eigen::Array3d next = products(residual, residual);
    direction = residual + ratio(next, squared).asDiagonal() * direction;
    squared = next;
  }
}

}  // namespace bespoke
