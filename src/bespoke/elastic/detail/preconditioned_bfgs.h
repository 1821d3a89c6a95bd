#pragma once

#include <functional>

#include "bespoke/types.h"

namespace bespoke {

struct MinimiserOptions {
  int max_iterations = 0;  ///< > 0
  /// Stops when two iterations in a row each lower the energy by less than this fraction.
  double min_relative_decrease = 0;
};

/// The energy at x (3×n) and, where it is finite, its gradient there.
using Energy = std::function<double(const Points& x, Points& gradient)>;

/// About the inverse of the Hessian's diagonal where the energy was last evaluated, n, one number a column.
using InverseDiagonal = std::function<Eigen::VectorXd()>;

/// Moves x, of finite energy, to lower energy: limited-memory BFGS (Liu and Nocedal 1989) whose initial
/// inverse Hessian is that diagonal, with a backtracking line search that never accepts an infinite energy.
/// Returns the number of iterations. The same bits at any thread count.
int minimise(const Energy& energy, const InverseDiagonal& inverse_diagonal, const MinimiserOptions& options,
             Points& x);

}  // namespace bespoke
