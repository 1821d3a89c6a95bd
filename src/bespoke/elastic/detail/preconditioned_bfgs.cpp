#include "bespoke/elastic/detail/preconditioned_bfgs.h"

#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t memory = 6;   // pairs that are kept
constexpr double armijo = 1e-4;     // Nocedal and Wright, Numerical Optimization, 3.1
constexpr int max_halvings = 20;    // of a step
constexpr double first_step = 0.3;  // of the diagonal's, before any pair tells the scale
constexpr std::size_t columns_per_task = 8192;

double dot(const Points& a, const Points& b) {
  const auto partial = [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
    return a.middleCols(first, count).cwiseProduct(b.middleCols(first, count)).sum();
  };
  return parallel_reduce(static_cast<std::size_t>(a.cols()), columns_per_task, 0.0, partial,
                         [](double x, double y) { return x + y; });
}

/// y += factor · x
void add(double factor, const Points& x, Points& y) {
  parallel_for(static_cast<std::size_t>(x.cols()), columns_per_task, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin), count = static_cast<Eigen::Index>(end - begin);
    y.middleCols(first, count) += factor * x.middleCols(first, count);
  });
}

/// Limited-memory BFGS (Nocedal 1980): the last steps, and how the gradient changed along them.
class InverseHessian {
 public:
  void set_diagonal(Eigen::VectorXd diagonal) {
    diagonal_ = std::move(diagonal);
    if (!pairs_.empty()) {
      const Pair& last = pairs_.back();
      scale_ = last.product / dot(last.change, Points(last.change * diagonal_.asDiagonal()));
    }
  }

  bool empty() const { return pairs_.empty(); }

  void learn(Points step, Points change) {
    const double product = dot(step, change);
    if (!(product > 0)) return;
    pairs_.push_back({std::move(step), std::move(change), product});
    if (pairs_.size() > memory) pairs_.pop_front();
  }

  Points operator*(const Points& gradient) const {
    Points result = gradient;
    std::vector<double> alphas(pairs_.size());
    for (std::size_t i = pairs_.size(); i-- > 0;) {
      alphas[i] = dot(pairs_[i].step, result) / pairs_[i].product;
      add(-alphas[i], pairs_[i].change, result);
    }
    result = scale_ * (result * diagonal_.asDiagonal());
    for (std::size_t i = 0; i < pairs_.size(); ++i)
      add(alphas[i] - dot(pairs_[i].change, result) / pairs_[i].product, pairs_[i].step, result);
    return result;
  }

 private:
  struct Pair {
    Points step, change;
    double product;
  };

  Eigen::VectorXd diagonal_;
  std::deque<Pair> pairs_;
  double scale_ = 1;
};

}  // namespace

int minimise(const Energy& energy, const InverseDiagonal& inverse_diagonal, const MinimiserOptions& options,
             Points& x) {
  Points gradient, next_gradient;
  double now = energy(x, gradient);
  InverseHessian inverse;
  int iteration = 0;
  for (int slow = 0; iteration < options.max_iterations && slow < 2; ++iteration) {
    inverse.set_diagonal(inverse_diagonal());
    const Points direction = inverse * gradient;
    const double slope = dot(gradient, direction);
    double step = inverse.empty() ? first_step : 1;
    Points next;
    double then = 0;
    for (int halvings = 0; halvings <= max_halvings; ++halvings, step /= 2) {
      next = x;
      add(-step, direction, next);
      then = energy(next, next_gradient);
      if (then <= now - armijo * step * slope) break;
    }
    if (!(then < now)) break;
    slow = now - then < options.min_relative_decrease * now ? slow + 1 : 0;
    inverse.learn(next - x, next_gradient - gradient);
    x = std::move(next);
    std::swap(gradient, next_gradient);
    now = then;
  }
  return iteration;
}

}  // namespace bespoke
