#include "bespoke/elastic/detail/preconditioned_bfgs.h"

#include <cmath>
#include <cstddef>
#include <deque>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t memory = 6;   // pairs that are kept
constexpr double armijo = 1e-4;     // Nocedal and Wright, Numerical Optimization, 3.1
constexpr int max_dampings = 3;     // before a step is halved as a whole
constexpr int max_trials = 30;      // of a line search
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

struct LineSearch {
  Points x, gradient;
  double energy = 0;
  int evaluations = 0;
};

/// From x of an energy along −direction, which is damped where it leads to an infinite energy.
LineSearch search(const Objective& objective, const Points& x, double energy, const Points& gradient,
                  Points direction) {
  LineSearch result;
  double slope = dot(gradient, direction), step = 1;
  for (int damped = 0; result.evaluations < max_trials;) {
    result.x = x;
    add(-step, direction, result.x);
    result.energy = objective.energy(result.x, result.gradient);
    ++result.evaluations;
    if (result.energy <= energy - armijo * step * slope) break;
    if (std::isinf(result.energy) && damped < max_dampings) {
      Points shorter = direction;
      objective.damp(shorter);
      if (const double then = dot(gradient, shorter); then > 0) {
        direction = std::move(shorter);
        slope = then;
        ++damped;
        continue;
      }
    }
    damped = 0;
    step /= 2;
  }
  return result;
}

}  // namespace

int minimise(const Objective& objective, const MinimiserOptions& options, Points& x) {
  Points gradient;
  double now = objective.energy(x, gradient);
  InverseHessian inverse;
  int iteration = 0, evaluations = 1;
  for (int slow = 0; iteration < options.max_iterations && evaluations < options.max_evaluations && slow < 2;
       ++iteration) {
    inverse.set_diagonal(objective.inverse_diagonal());
    Points direction = inverse * gradient;
    if (inverse.empty()) direction *= first_step;
    LineSearch next = search(objective, x, now, gradient, std::move(direction));
    evaluations += next.evaluations;
    if (!(next.energy < now)) break;
    slow = now - next.energy < options.min_relative_decrease * now ? slow + 1 : 0;
    inverse.learn(next.x - x, next.gradient - gradient);
    x = std::move(next.x);
    gradient = std::move(next.gradient);
    now = next.energy;
  }
  return iteration;
}

}  // namespace bespoke
