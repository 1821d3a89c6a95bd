#include "bespoke/certificate/jacobian_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/instruction_sets.h"

namespace bespoke {
namespace {

NodeBlock random_block(double amplitude) {
  std::mt19937 engine(1);
  std::uniform_real_distribution<double> value(-amplitude, amplitude);
  NodeBlock block;
  for (auto& component : block)
    for (double& node : component) node = value(engine);
  return block;
}

Matrix3 sheared_matrix() {
  Matrix3 linear;
  linear << 1.1, 0.2, 0, 0, 0.9, 0.1, 0.05, 0, 1;
  return linear;
}

TEST(BoundBlock, IsTheLeastCoefficientOfEachCellLessTheMargin) {
  const NodeBlock sum = random_block(0.3);
  JacobianBlock block;
  bound_block(sum, sheared_matrix(), 1.5, 1e-9, block);
  EXPECT_GT(block.margin, 1e-9);
  EXPECT_LT(block.margin, 1e-5);
  for (int cell = 0; cell < leaf_nodes; ++cell) {
    const BezierDeterminant coefficients = bezier_coefficients(sum, cell, sheared_matrix(), 1.5);
    const double least = *std::min_element(coefficients.begin(), coefficients.end());
    EXPECT_NEAR(block.lower_bound[static_cast<std::size_t>(cell)], least - block.margin, 1e-13);
  }
}

TEST(BoundBlock, GivesTheSameBitsWithEveryInstructionSet) {
  for (const double amplitude : {1e-6, 0.3, 100.0}) {
    const NodeBlock sum = random_block(amplitude);
    test::expect_same_bits_with_every_instruction_set([&] {
      JacobianBlock block;
      bound_block(sum, sheared_matrix(), 1.5, 1e-9, block);
      return std::vector<double>(block.lower_bound.begin(), block.lower_bound.end());
    });
  }
}

}  // namespace
}  // namespace bespoke
