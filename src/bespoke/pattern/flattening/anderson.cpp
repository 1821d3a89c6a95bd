#include "bespoke/pattern/flattening/anderson.h"

#include <Eigen/Cholesky>

namespace bespoke {
namespace {

// As in the paper, whose authors found 5 to 10 alike.
constexpr std::size_t window = 6;

// Of the normal equations' largest diagonal entry: keeps near-parallel residuals apart.
constexpr double ridge = 1e-12;

}  // namespace

Eigen::VectorXd Anderson::next(const Eigen::VectorXd& x, const Eigen::VectorXd& image) {
  images_.push_front(image);
  residuals_.push_front(image - x);
  if (images_.size() > window) {
    images_.pop_back();
    residuals_.pop_back();
  }
  const auto count = static_cast<Eigen::Index>(images_.size()) - 1;
  if (count == 0) return image;
  Eigen::MatrixXd differences(x.size(), count);
  for (Eigen::Index k = 0; k < count; ++k)
    differences.col(k) =
        residuals_[static_cast<std::size_t>(k)] - residuals_[static_cast<std::size_t>(k) + 1];
  Eigen::MatrixXd normal = differences.transpose() * differences;
  normal.diagonal().array() += ridge * normal.diagonal().maxCoeff();
  const Eigen::VectorXd share = normal.ldlt().solve(differences.transpose() * residuals_.front());
  Eigen::VectorXd result = image;
  for (Eigen::Index k = 0; k < count; ++k)
    result -= share[k] * (images_[static_cast<std::size_t>(k)] - images_[static_cast<std::size_t>(k) + 1]);
  return result.allFinite() ? result : image;
}

void Anderson::forget() {
  images_.clear();
  residuals_.clear();
}

}  // namespace bespoke
