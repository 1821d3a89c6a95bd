#include "bespoke/anchors/detail/biharmonic_warp.h"

#include <algorithm>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

BiharmonicWarp::BiharmonicWarp(const Points& sources, const Points& targets)
    : sources_(sources), targets_(targets) {
  const Eigen::Index count = sources.cols();
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(count + 4, count + 4);
  Eigen::MatrixXd right_side = Eigen::MatrixXd::Zero(count + 4, 3);
  // A little smoothing, relative to the kernel's size, so that near duplicates do not dominate.
  const double smoothing = 1e-3 * diagonal(sources);
  for (Eigen::Index i = 0; i < count; ++i) {
    system.row(i).head(count) = -(sources.colwise() - sources.col(i)).colwise().norm();
    system(i, i) = smoothing;
    system(i, count) = system(count, i) = 1;
    system.row(i).tail<3>() = sources.col(i).transpose();
    system.col(i).tail<3>() = sources.col(i);
    right_side.row(i) = targets.col(i).transpose();
  }
  // Coplanar sources leave slopes undetermined; the pseudo-inverse takes the least.
  inverse_ = system.completeOrthogonalDecomposition().pseudoInverse();
  coefficients_ = inverse_ * right_side;
}

Vector3 BiharmonicWarp::operator()(const Vector3& x) const {
  const Eigen::Index count = sources_.cols();
  Eigen::RowVectorXd row(count + 4);
  row.head(count) = -(sources_.colwise() - x).colwise().norm();
  row[count] = 1;
  row.tail<3>() = x.transpose();
  return (row * coefficients_).transpose();
}

// Leave-one-out residuals in closed form: coefficient / diagonal of the inverse (Rippa 1999).
double BiharmonicWarp::left_out(Eigen::Index i) const { return coefficients_.row(i).norm() / stiffness(i); }

double BiharmonicWarp::stiffness(Eigen::Index i) const { return std::max(std::abs(inverse_(i, i)), 1e-300); }

// The energy is Σ B_ij y_i·y_j over the targets y, with B the inverse's block of the pairs; the rows of B y
// are the coefficients.
double BiharmonicWarp::energy() const {
  return targets_.transpose().cwiseProduct(coefficients_.topRows(targets_.cols())).sum();
}

double BiharmonicWarp::energy_without(Eigen::Index i) const {
  return energy() - coefficients_.row(i).squaredNorm() / stiffness(i);
}

double BiharmonicWarp::energy_interchanged(Eigen::Index i, Eigen::Index j) const {
  const Vector3 step = targets_.col(j) - targets_.col(i);
  const double slope = 2 * (coefficients_.row(i) - coefficients_.row(j)).dot(step.transpose());
  return energy() + slope + step.squaredNorm() * (inverse_(i, i) + inverse_(j, j) - 2 * inverse_(i, j));
}

}  // namespace bespoke
