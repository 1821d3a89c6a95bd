#include "bespoke/clearance/detail/smooth_correction.h"

#include <gtest/gtest.h>

#include "clearance/balls.h"

namespace bespoke {
namespace {

constexpr double tolerance = 1e-6;

/// One node moved along x by 0.1 at least, and further rows without amounts.
LinearConstraints constraints_on(const CorrectionGraph& graph, int rows) {
  LinearConstraints constraints;
  constraints.places.resize(rows, graph.nodes());
  constraints.places.insert(0, 5) = 1;
  constraints.gradients = NodeVectors::Zero(rows, 3);
  constraints.gradients.col(0).setOnes();
  constraints.amounts = Eigen::VectorXd::Constant(rows, 0.1);
  return constraints;
}

TEST(SmoothCorrection, MeetsAConstraintAndNoMore) {
  const CorrectionGraph graph = correction_graph(test::shell(1, 2), Eigen::Matrix2Xi(2, 0), {});
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(1);
  const NodeVectors u =
      minimised_energy(SmoothCorrection(graph), constraints_on(graph, 1), tolerance, 200, multipliers);
  EXPECT_NEAR(u(5, 0), 0.1, 2 * tolerance);
  EXPECT_LT(u.rightCols(2).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_NEAR(u.col(0).maxCoeff(), u(5, 0), 1e-12);
}

// Of faces that pass through each other, two corners may belong to one node: no move of it parts them.
TEST(SmoothCorrection, WhatMovesNoNodeIsLeft) {
  const CorrectionGraph graph = correction_graph(test::shell(1, 2), Eigen::Matrix2Xi(2, 0), {});
  LinearConstraints constraints = constraints_on(graph, 2);
  constraints.places.insert(1, 7) = 0;  // 1 − 1
  Eigen::VectorXd multipliers = Eigen::VectorXd::Zero(2);
  const NodeVectors u = minimised_energy(SmoothCorrection(graph), constraints, tolerance, 200, multipliers);
  ASSERT_TRUE(u.allFinite());
  EXPECT_NEAR(u(5, 0), 0.1, 2 * tolerance);
  EXPECT_EQ(multipliers[1], 0);
}

}  // namespace
}  // namespace bespoke
