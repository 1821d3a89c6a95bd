#include "bespoke/rbf/layer_stack.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/rbf/kernels.h"
#include "support/finite_differences.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

struct Layer {
  Points centers;
  Points coefficients;
  double lambda;
};

Layer random_layer(int count, double lambda, unsigned seed) {
  return {test::random_points(count, seed), 0.02 * test::random_points(count, seed + 1), lambda};
}

LayerStack stack_of(const std::vector<Layer>& layers, Stacking stacking, Wendland function = Wendland::c2) {
  std::vector<LayerEvaluator> evaluators;
  for (const Layer& layer : layers)
    evaluators.emplace_back(layer.centers, layer.coefficients, layer.lambda, function);
  return {std::move(evaluators), stacking};
}

/// The definition.
template <class Kernel>
Vector3 naive(const Layer& layer, const Vector3& x) {
  Vector3 sum = Vector3::Zero();
  for (Eigen::Index j = 0; j < layer.centers.cols(); ++j)
    sum += layer.coefficients.col(j) * Kernel::value((x - layer.centers.col(j)).norm() / layer.lambda);
  return sum;
}

TEST(LayerStack, SumsTheDefinitionAtAnyDensityOfPoints) {
  for (const double spread : {0.01, 0.3, 1.0, 30.0})
    for (const int count : {1, 7, 8, 9, 1000}) {
      const Layer layer = random_layer(200, 0.4, 1);
      const Points x = spread * test::random_points(count, 3);
      const Points c2 = stack_of({layer}, Stacking::summed).displacement(x);
      const Points c4 = stack_of({layer}, Stacking::summed, Wendland::c4).displacement(x);
      for (Eigen::Index i = 0; i < x.cols(); ++i) {
        EXPECT_LT((c2.col(i) - naive<WendlandC2>(layer, x.col(i))).norm(), 1e-14);
        EXPECT_LT((c4.col(i) - naive<WendlandC4>(layer, x.col(i))).norm(), 1e-14);
      }
    }
}

TEST(LayerStack, ComposesInTheGivenOrder) {
  const Layer first = random_layer(50, 0.9, 5);
  const Layer second = random_layer(80, 0.3, 7);
  const Points x = test::random_points(500, 9);
  const Points u = stack_of({first, second}, Stacking::composed).displacement(x);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 moved = x.col(i) + naive<WendlandC2>(first, x.col(i));
    EXPECT_LT((x.col(i) + u.col(i) - moved - naive<WendlandC2>(second, moved)).norm(), 1e-14);
  }
}

TEST(LayerStack, GradientsEqualFiniteDifferences) {
  const std::vector<Layer> layers{random_layer(50, 0.9, 11), random_layer(80, 0.5, 13)};
  for (const Stacking stacking : {Stacking::summed, Stacking::composed})
    for (const Wendland function : {Wendland::c2, Wendland::c4}) {
      const LayerStack stack = stack_of(layers, stacking, function);
      const Points x = test::random_points(300, 15);
      EXPECT_LT((stack.gradient(x) - test::finite_differences(stack, x, 1e-5)).cwiseAbs().maxCoeff(), 1e-7);
    }
}

TEST(LayerStack, GradientIsExactAtACentre) {
  const Layer layer{Points::Zero(3, 1), Vector3(1, 2, 3), 0.5};
  EXPECT_EQ(stack_of({layer}, Stacking::summed).gradient(Points::Zero(3, 1)), Points::Zero(3, 3));
  EXPECT_EQ(stack_of({layer}, Stacking::summed).displacement(Points::Zero(3, 1)), Points(Vector3(1, 2, 3)));
}

TEST(LayerStack, IsExactlyZeroBeyondEveryRadius) {
  const Layer layer = random_layer(40, 0.25, 17);
  const Points x = 2 * test::random_points(2000, 19);
  const LayerStack stack = stack_of({layer}, Stacking::composed);
  const Points u = stack.displacement(x);
  const Points gradient = stack.gradient(x);
  int beyond = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if ((layer.centers.colwise() - x.col(i)).colwise().norm().minCoeff() < layer.lambda) continue;
    ++beyond;
    EXPECT_EQ(u.col(i), Vector3::Zero());
    EXPECT_EQ(gradient.middleCols(3 * i, 3), Points::Zero(3, 3));
  }
  EXPECT_GT(beyond, 1000);
}

TEST(LayerStack, GivesEachPointTheSameBitsInAnyCompany) {
  const LayerStack stack =
      stack_of({random_layer(300, 0.5, 21), random_layer(300, 0.1, 23)}, Stacking::composed);
  const Points x = test::random_points(3000, 25);
  const Points together = stack.displacement(x);
  EXPECT_EQ(stack.displacement(x.rowwise().reverse()), together.rowwise().reverse());
  for (Eigen::Index i = 0; i < 200; ++i) EXPECT_EQ(stack.displacement(x.col(i)), together.col(i));
}

TEST(LayerStack, AnswersNaNWithNaNAndInfinityWithZero) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const LayerStack stack = stack_of({random_layer(30, 0.8, 27)}, Stacking::summed);
  Points x = test::random_points(20, 29);
  const Points before = stack.displacement(x);
  x(1, 4) = std::numeric_limits<double>::quiet_NaN();
  x.col(5).setConstant(infinity);
  const Points u = stack.displacement(x);
  EXPECT_TRUE(u.col(4).array().isNaN().all());
  EXPECT_TRUE(stack.gradient(x).middleCols(12, 3).array().isNaN().all());
  EXPECT_EQ(u.col(5), Vector3::Zero());
  EXPECT_EQ(u.leftCols(4), before.leftCols(4));
  EXPECT_EQ(u.rightCols(14), before.rightCols(14));
}

TEST(LayerStack, OfNothingIsZero) {
  const Points x = test::random_points(5, 31);
  EXPECT_EQ(LayerStack({}, Stacking::composed).displacement(x), Points::Zero(3, 5));
  const Layer empty{Points(3, 0), Points(3, 0), 1};
  EXPECT_EQ(stack_of({empty}, Stacking::summed).displacement(x), Points::Zero(3, 5));
  EXPECT_EQ(stack_of({random_layer(5, 1, 33)}, Stacking::summed).displacement(Points(3, 0)).cols(), 0);
}

}  // namespace
}  // namespace bespoke
