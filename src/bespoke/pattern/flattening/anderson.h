#pragma once

#include <Eigen/Core>
#include <deque>

namespace bespoke {

/// Anderson's acceleration of a fixed-point iteration x → g(x): the combination of the last iterates whose
/// residuals g(x) − x cancel best (Peng, Deng, Zhang, Geng, Qin and Liu 2018).
class Anderson {
 public:
  /// The next iterate after x, g(x); g(x) itself at first and after forget().
  Eigen::VectorXd next(const Eigen::VectorXd& x, const Eigen::VectorXd& image);
  void forget();

 private:
  std::deque<Eigen::VectorXd> images_, residuals_;
};

}  // namespace bespoke
