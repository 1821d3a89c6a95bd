#pragma once

#include <functional>

#include "bespoke/types.h"

namespace bespoke {

struct MinimiserOptions {
  int max_iterations = 0;   ///< > 0
  int max_evaluations = 0;  ///< of the energy, > 0
  /// Stops when two iterations in a row each lower the energy by less than this fraction.
  double min_relative_decrease = 0;
};

/// A function of 3×n numbers.
struct Objective {
  /// The energy at x and, where it is finite, its gradient there.
  std::function<double(const Points& x, Points& gradient)> energy;
  /// About the inverse of the Hessian's diagonal where the energy was last evaluated, n, one number a column.
  std::function<Eigen::VectorXd()> inverse_diagonal;
  /// After an infinite energy: shortens a step where that came from.
  std::function<void(Points& step)> damp;
};

/// Moves x, of finite energy, to lower energy: limited-memory BFGS (Liu and Nocedal 1989) whose initial
/// inverse Hessian is that diagonal, with a backtracking line search that never accepts an infinite energy.
/// A step that ends at one is damped where it must be before it is halved as a whole (after the line-search
/// filter of Zhu, Bridson and Kaufman 2018). Returns the number of iterations. The same bits at any thread
/// count.
int minimise(const Objective& objective, const MinimiserOptions& options, Points& x);

}  // namespace bespoke
