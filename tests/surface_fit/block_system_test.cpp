#include "bespoke/surface_fit/graph/block_system.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"

namespace bespoke {
namespace {

TEST(BlockSystem, SolvesAChainOfSprings) {
  // Fixed at both ends with springs of stiffness 1 between: positions on a straight line. Many enough for
  // several fronts.
  constexpr int count = 300;
  std::vector<std::vector<int>> adjacency(count);
  Points places = Points::Zero(3, count);
  for (int i = 0; i < count; ++i) places(0, i) = i;
  for (int i = 0; i + 1 < count; ++i) {
    adjacency[i].push_back(i + 1);
    adjacency[i + 1].push_back(i);
  }
  BlockSystem system(adjacency, places);
  const Matrix3 one = Matrix3::Identity();
  for (int round = 0; round < 2; ++round) {  // the second round sees none of the first
    system.set_zero();
    for (int i = 0; i + 1 < count; ++i) {
      system.add(i, i, one);
      system.add(i + 1, i + 1, one);
      system.add(i, i + 1, -one);
      system.add(i + 1, i, -one);
    }
    system.add(0, 0, one);
    system.add(count - 1, count - 1, one);
    system.add_right_side(count - 1, Vector3(6, -12, 18));
    const Points solution = system.solve();
    for (int i = 0; i < count; ++i)
      EXPECT_LT((solution.col(i) - (i + 1.0) * Vector3(6, -12, 18) / (count + 1)).norm(), 1e-10);
  }
  // A unit force at a spring's end: the two parts of the chain share it.
  for (const int i : {0, 77, count - 1})
    EXPECT_LT((system.compliance({{i, 0.25}, {i, 0.75}}) -
               (i + 1.0) * (count - i) / (count + 1) * Matrix3::Identity())
                  .norm(),
              1e-9);
}

TEST(BlockSystem, CouplesTheCoordinatesOfABlock) {
  BlockSystem system(std::vector<std::vector<int>>(1), Points::Zero(3, 1));
  Matrix3 matrix;
  matrix << 4, 1, 0.5, 1, 3, -1, 0.5, -1, 2;
  system.add(0, 0, matrix);
  system.add_right_side(0, matrix * Vector3(1, 2, 3));
  EXPECT_LT((system.solve().col(0) - Vector3(1, 2, 3)).norm(), 1e-12);
}

TEST(BlockSystem, SaysThatAMatrixIsNotDefinite) {
  BlockSystem system(std::vector<std::vector<int>>(2), Points::Zero(3, 2));
  system.add(0, 0, Matrix3::Identity());
  system.add(1, 1, -Matrix3::Identity());
  EXPECT_THROW(system.solve(), SolverError);
}

}  // namespace
}  // namespace bespoke
