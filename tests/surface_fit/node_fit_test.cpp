#include "bespoke/surface_fit/graph/node_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "support/arithmetic.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::infinity;

/// About the diagonal of a ball of radius 1: what a fit takes has one of about 1.
constexpr double ball_size = 3.5;

NodeFit fit_nodes(const NodeFitInput& input) {
  const NodeFitSettings settings;
  const Progress progress;
  NodeFitting fitting(input, settings, progress);
  fitting.fit_coarse();
  return fitting.fit_fine();
}

TEST(FitNodes, FollowsASmoothBendOfAFeaturedSurface) {
  TriangleMesh source = shapes::icosphere(4);
  for (auto&& x : source.vertices.colwise()) x *= 1 + 0.2 * std::sin(4 * x[0]) * std::cos(3 * x[2]);
  const auto bend = [](const Vector3& x) { return Vector3(x[0] + 0.1 * x[1] * x[1], 1.1 * x[1], x[2]); };
  TriangleMesh target = source;
  for (auto&& x : target.vertices.colwise()) x = bend(x);
  source.vertices /= ball_size;
  target.vertices /= ball_size;
  const std::vector<int> marked{0, 2, 4, 6, 8, 10};
  const Points anchors = source.vertices(Eigen::all, marked),
               anchor_targets = target.vertices(Eigen::all, marked);
  const TargetSurface surface(target);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(6, infinity);
  const NodeFit fit = fit_nodes({source, source.vertices, surface, anchors, anchor_targets, weights});
  EXPECT_LT((fit.vertices - target.vertices).colwise().norm().mean(), 0.01 / ball_size);
  EXPECT_LT((fit.anchor_sources - anchor_targets).colwise().norm().maxCoeff(), 0.01 / ball_size);
}

TEST(FitNodes, TellsBodiesThatKeepTheirShapeFromOthers) {
  TriangleMesh source = shapes::icosphere(4);
  for (auto&& x : source.vertices.colwise()) x *= 1 + 0.2 * std::sin(4 * x[0]) * std::cos(3 * x[2]);
  source.vertices /= ball_size;
  const std::vector<int> marked{0, 7, 20, 33, 60, 90};
  const Points anchors = source.vertices(Eigen::all, marked);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(6, infinity);
  const auto rigidity = [&](const auto& change) {
    TriangleMesh target = source;
    for (auto&& x : target.vertices.colwise()) x = change(Vector3(x));
    const Points goals = target.vertices(Eigen::all, marked);
    const TargetSurface surface(target);
    return fit_nodes({source, source.vertices, surface, anchors, goals, weights}).rigidity;
  };
  const auto twist = [](double radians_per_radius) {
    return [=](const Vector3& x) {
      return Vector3(Eigen::AngleAxisd(radians_per_radius * ball_size * x[0], Vector3::UnitX()) * x);
    };
  };
  const NodeFitSettings settings;
  EXPECT_EQ(rigidity([](const Vector3& x) { return x; }), settings.shape.max_rigid);
  const double little = rigidity(twist(0.05)), more = rigidity(twist(0.15));
  EXPECT_GT(little, more);
  EXPECT_GT(more, 1);
  EXPECT_EQ(
      rigidity([](const Vector3& x) { return Vector3(x[0], x[1] * (1.3 + 0.3 * ball_size * x[0]), x[2]); }),
      1);
}

// A sphere with a cap that stands out, as a bent source may where a joint bends at another place than the
// target's; anchors around the cap are met.
TEST(FitNodes, ABentSourceMovesInwardWhereItIsOutside) {
  TriangleMesh sphere = shapes::icosphere(4);
  sphere.vertices /= ball_size;
  TriangleMesh source = sphere;
  std::vector<int> cap, marked;
  for (int i = 0; i < sphere.vertices.cols(); ++i) {
    const double height = ball_size * sphere.vertices(2, i);
    if (height > 0.9) cap.push_back(i);
    source.vertices.col(i) *= 1 + 0.08 * std::max(0.0, height - 0.8) / 0.2;
    if (i < 42 && height < 0.8) marked.push_back(i);
  }
  const Points anchors = sphere.vertices(Eigen::all, marked);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(anchors.cols(), infinity);
  const TargetSurface surface(sphere);
  const auto height_of_cap = [&](bool is_posed) {
    NodeFitInput input{source, source.vertices, surface, anchors, anchors, weights};
    input.is_posed = is_posed;
    const Points fitted = fit_nodes(input).vertices(Eigen::all, cap);
    return (ball_size * fitted.colwise().norm().array() - 1).abs().mean();
  };
  EXPECT_LT(height_of_cap(true), 0.5 * height_of_cap(false));
}

TEST(FitNodes, WeighsSoftAnchorsLess) {
  TriangleMesh sphere = shapes::icosphere(3);
  sphere.vertices /= ball_size;
  const TargetSurface surface(sphere);
  const Points anchors = sphere.vertices.leftCols(4);
  Points targets = anchors;
  targets.col(0) *= 1.3;
  double last = 0;
  for (const double weight : {0.01, 1.0, 100.0, infinity}) {
    const Eigen::VectorXd weights = Eigen::VectorXd::Constant(4, weight);
    const NodeFit fit = fit_nodes({sphere, sphere.vertices, surface, anchors, targets, weights});
    const double pulled = ball_size * fit.anchor_sources.col(0).norm() - 1;
    EXPECT_GT(pulled, last);
    last = pulled;
  }
  EXPECT_LT(last, 0.3 + 1e-3);
}

}  // namespace
}  // namespace bespoke
