#include "bespoke/rbf/conjugate_gradients.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/random_points.h"

namespace bespoke {
namespace {

/// A dense matrix of eigenvalues between 1 and `condition`, and the diagonal or nothing as preconditioner.
struct DenseSystem {
  DenseSystem(Eigen::Index count, double condition, bool preconditioned) : jacobi(preconditioned) {
    const Eigen::MatrixXd random = Eigen::MatrixXd::NullaryExpr(count, count, [] {
      static std::mt19937 generator(1);
      return std::normal_distribution<double>()(generator);
    });
    const Eigen::MatrixXd axes = Eigen::HouseholderQR<Eigen::MatrixXd>(random).householderQ();
    const Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(count, 1, condition);
    matrix = axes * values.asDiagonal() * axes.transpose();
  }

  Points multiply(const Points& x) const { return x * matrix; }
  Points precondition(const Points& r) const {
    return jacobi ? Points(r * matrix.diagonal().cwiseInverse().asDiagonal()) : r;
  }
  Vector3 products(const Points& a, const Points& b) const { return a.cwiseProduct(b).rowwise().sum(); }
  bool solved(const Points& residual, const Vector3&, int steps) const {
    return steps == max_steps || residual.cwiseAbs().maxCoeff() <= 1e-12;
  }

  Eigen::MatrixXd matrix;
  bool jacobi;
  int max_steps = 1000;
};

TEST(ConjugateGradients, SolveFromAnyStart) {
  for (const bool preconditioned : {false, true}) {
    const DenseSystem system(30, 50, preconditioned);
    const Points truth = test::random_points(30, 2);
    const Points right = system.multiply(truth);
    for (Points solution : {Points(Points::Zero(3, 30)), test::random_points(30, 3)}) {
      conjugate_gradients(system, solution, right - system.multiply(solution));
      EXPECT_LT((solution - truth).cwiseAbs().maxCoeff(), 1e-11);
    }
  }
}

TEST(ConjugateGradients, NeedAsManyStepsAsThereAreEigenvaluesAtMost) {
  DenseSystem system(8, 5, false);
  Points solution = Points::Zero(3, 8);
  EXPECT_LE(conjugate_gradients(system, solution, test::random_points(8, 4)), 9);
  system.matrix = 3 * Eigen::MatrixXd::Identity(8, 8);
  solution.setZero();
  EXPECT_EQ(conjugate_gradients(system, solution, test::random_points(8, 5)), 1);
}

TEST(ConjugateGradients, LeaveASolvedRowAsItIs) {
  const DenseSystem system(20, 30, false);
  Points residual = test::random_points(20, 6);
  residual.row(1).setZero();
  Points solution = Points::Constant(3, 20, 0.25);
  conjugate_gradients(system, solution, residual);
  EXPECT_EQ(solution.row(1), Points::Constant(3, 20, 0.25).row(1));
}

TEST(ConjugateGradients, StopWhenTheSystemSaysSo) {
  DenseSystem system(20, 30, false);
  system.max_steps = 3;
  Points solution = Points::Zero(3, 20);
  EXPECT_EQ(conjugate_gradients(system, solution, test::random_points(20, 7)), 3);
}

}  // namespace
}  // namespace bespoke
