#include "bespoke/surface_fit/detail/node_fit.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

TEST(FitNodes, FollowsASmoothBendOfAFeaturedSurface) {
  TriangleMesh source = shapes::icosphere(4);
  for (auto&& x : source.vertices.colwise()) x *= 1 + 0.2 * std::sin(4 * x[0]) * std::cos(3 * x[2]);
  const auto bend = [](const Vector3& x) { return Vector3(x[0] + 0.1 * x[1] * x[1], 1.1 * x[1], x[2]); };
  TriangleMesh target = source;
  for (auto&& x : target.vertices.colwise()) x = bend(x);
  Points anchors(3, 6), anchor_targets(3, 6);
  for (int k = 0; k < 6; ++k) {
    anchors.col(k) = source.vertices.col(2 * k);
    anchor_targets.col(k) = bend(anchors.col(k));
  }
  const TargetSurface surface(target);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(6, infinity);
  const NodeFit fit =
      fit_nodes({source, surface, anchors, anchor_targets, weights, diagonal(source.vertices)}, {}, {});
  EXPECT_LT((fit.vertices - target.vertices).colwise().norm().mean(), 0.01);
  EXPECT_LT((fit.anchor_sources - anchor_targets).colwise().norm().maxCoeff(), 0.01);
}

TEST(FitNodes, WeighsSoftAnchorsLess) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const TargetSurface surface(sphere);
  const Points anchors = sphere.vertices.leftCols(4);
  Points targets = anchors;
  targets.col(0) *= 1.3;
  double last = 0;
  for (const double weight : {0.01, 1.0, 100.0, infinity}) {
    const NodeFit fit = fit_nodes(
        {sphere, surface, anchors, targets, Eigen::VectorXd::Constant(4, weight), diagonal(sphere.vertices)},
        {}, {});
    const double pulled = fit.anchor_sources.col(0).norm() - 1;
    EXPECT_GT(pulled, last);
    last = pulled;
  }
  EXPECT_LT(last, 0.3 + 1e-3);
}

}  // namespace
}  // namespace bespoke
