#include "bespoke/rbf/gradient_bound.h"

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include <algorithm>

#include "bespoke/rbf/kernels.h"
#include "bespoke/rbf/layer_stack.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

constexpr auto rough = GradientBound::Closeness::rough;
constexpr auto tight = GradientBound::Closeness::tight;

double spectral_norm(const Matrix3& matrix) { return Eigen::JacobiSVD<Matrix3>(matrix).singularValues()[0]; }

Eigen::VectorXd gradient_norms(const RbfLayer& layer, const Points& x) {
  const LayerStack stack({LayerEvaluator(layer.centers, layer.coefficients, layer.lambda, Wendland::c2)},
                         Stacking::summed);
  const Points gradient = stack.gradient(x);
  Eigen::VectorXd norms(x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) norms[i] = spectral_norm(gradient.middleCols<3>(3 * i));
  return norms;
}

double bound_of(const RbfLayer& layer, double enough) {
  GradientBound bound;
  bound.update(layer, enough, tight);
  return bound.largest();
}

TEST(GradientBound, OfOneCentreIsTheKernelsSteepestSlope) {
  const RbfLayer layer{2.0, Points::Zero(3, 1), Vector3(0, 0.3, 0.4)};
  const double exact = 0.5 * WendlandC2::max_slope / 2.0;
  const double bound = bound_of(layer, 0.1);
  EXPECT_GE(bound, exact);
  EXPECT_LT(bound, 1.25 * exact);
}

TEST(GradientBound, IsNeverExceeded) {
  for (unsigned seed = 0; seed < 6; ++seed)
    for (const double enough : {0.05, 0.5, 5.0}) {
      const double lambda = 0.3 + 0.2 * seed;
      const RbfLayer layer{lambda, test::random_points(60, seed), 0.05 * test::random_points(60, seed + 50)};
      const double bound = bound_of(layer, enough);
      EXPECT_LE(gradient_norms(layer, 1.5 * test::random_points(20000, seed + 100)).maxCoeff(), bound);
      EXPECT_LE(gradient_norms(layer, layer.centers).maxCoeff(), bound);
    }
}

TEST(GradientBound, IsTightWhereTheGradientExceedsEnough) {
  const RbfLayer layer{0.8, test::random_points(60, 1), 0.05 * test::random_points(60, 2)};
  const double sampled = gradient_norms(layer, 1.5 * test::random_points(200000, 3)).maxCoeff();
  EXPECT_LT(bound_of(layer, 0.9 * sampled), 1.4 * sampled);
}

TEST(GradientBound, SteepPlacesHoldEveryPointThatIsSteep) {
  const RbfLayer layer{0.5, test::random_points(80, 4), 0.05 * test::random_points(80, 5)};
  const Points x = 1.4 * test::random_points(50000, 6);
  const Eigen::VectorXd norms = gradient_norms(layer, x);
  const double enough = 0.5 * norms.maxCoeff();
  GradientBound bound;
  bound.update(layer, enough, rough);
  const auto places = bound.steep_places();
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (norms[i] <= enough) continue;
    EXPECT_TRUE(std::any_of(places.begin(), places.end(), [&](const GradientBound::SteepPlace& place) {
      return (place.center - x.col(i)).norm() <= place.radius;
    }));
  }
}

TEST(GradientBound, OfAChangedLayerIsThatOfTheLayerBoundedAnew) {
  RbfLayer layer{0.4, test::random_points(100, 7), 0.05 * test::random_points(100, 8)};
  GradientBound bound;
  bound.update(layer, 0.3, rough);
  std::vector<char> changed(100, 0);
  for (int j = 0; j < 100; j += 20) {
    changed[std::size_t(j)] = 1;
    layer.coefficients.col(j) *= 0.5;
  }
  bound.update(layer, 0.3, rough, changed);
  GradientBound anew;
  anew.update(layer, 0.3, rough);
  EXPECT_EQ(bound.largest(), anew.largest());
}

TEST(GradientBound, OfNothingIsZero) {
  EXPECT_EQ(bound_of({1.0, Points(3, 0), Points(3, 0)}, 0.5), 0);
  EXPECT_EQ(bound_of({1.0, test::random_points(5, 9), Points::Zero(3, 5)}, 0.5), 0);
}

}  // namespace
}  // namespace bespoke
