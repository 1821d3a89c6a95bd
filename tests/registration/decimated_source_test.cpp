#include "bespoke/registration/detail/decimated_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/registration/registration.h"
#include "bespoke/statistics.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// Turned about the z axis by an angle that grows with z, and widened.
Vector3 bent(const Vector3& x) {
  const double angle = 0.4 * x.z(), width = 1 + 0.2 * x.z() * x.z();
  return {width * (std::cos(angle) * x.x() - std::sin(angle) * x.y()),
          width * (std::sin(angle) * x.x() + std::cos(angle) * x.y()), 1.3 * x.z()};
}

Points bent(const Points& points) {
  Points result = points;
  for (auto&& x : result.colwise()) x = bent(Vector3(x));
  return result;
}

double largest_distance(const Points& a, const Points& b) { return (a - b).colwise().norm().maxCoeff(); }

TEST(DecimatedSource, GoesWithASimilarity) {
  const TriangleMesh ball = shapes::icosphere(5);
  const DecimatedSource fewer(ball, 2000);
  ASSERT_LE(fewer.mesh().faces.cols(), 2000);
  const Eigen::AngleAxisd turn(2, Vector3(1, 2, 3).normalized());
  const AffineMap map{1.7 * turn.toRotationMatrix(), {1, -2, 3}};
  EXPECT_LT(largest_distance(fewer.followed(map * fewer.mesh().vertices), map * ball.vertices), 1e-7);
}

// Faces alone would be off by what edges of length h cut off a bend, some h² / 8.
TEST(DecimatedSource, FollowsABendCloserThanFlatFaces) {
  const TriangleMesh ball = shapes::icosphere(5);
  const DecimatedSource fewer(ball, 2000);
  const Points moved = bent(fewer.mesh().vertices), truth = bent(ball.vertices);
  const ClosestPointTree flat({moved, fewer.mesh().faces});
  double off_flat = 0;
  for (const auto& x : truth.colwise()) off_flat = std::max(off_flat, flat.closest(x)->squared_distance);
  EXPECT_LT(largest_distance(fewer.followed(moved), truth), 0.5 * std::sqrt(off_flat));
}

TEST(DecimatedSource, KeepsVerticesOnTheirSideOfAThinGap) {
  TriangleMesh below = shapes::square_grid(60), above = below;
  above.faces.row(0).swap(above.faces.row(1));  // faces down
  above.vertices.row(2).array() += 1e-4;
  const TriangleMesh both = shapes::joined(below, above);
  const DecimatedSource fewer(both, 200);
  Points moved = fewer.mesh().vertices;
  for (auto&& x : moved.colwise())
    if (x.z() > 5e-5) x.z() += 1;
  const Points followed = fewer.followed(moved);
  for (Eigen::Index i = 0; i < followed.cols(); ++i)
    EXPECT_NEAR(followed(2, i), i < below.vertices.cols() ? 0 : 1.0001, 1e-6) << i;
}

TEST(DecimatedSource, KnowsWhatFollowsAVertex) {
  const TriangleMesh ball = shapes::icosphere(4);
  const DecimatedSource fewer(ball, 500);
  Points moved = fewer.mesh().vertices;
  moved.col(7) *= 2;
  const Points before = fewer.followed(fewer.mesh().vertices), after = fewer.followed(moved);
  const std::vector<int> followers = fewer.followers({7});
  EXPECT_TRUE(std::binary_search(followers.begin(), followers.end(), fewer.vertices()[7]));
  const double gone = after.col(fewer.vertices()[7]).norm() - 1;
  for (int vertex = 0; vertex < ball.vertices.cols(); ++vertex) {
    if (!std::binary_search(followers.begin(), followers.end(), vertex)) {
      // Corners nearby take part by their gradients alone.
      EXPECT_LT((after.col(vertex) - before.col(vertex)).norm(), 0.2 * gone);
    }
  }
}

// Flat faces of edge h would be off by h² / 8 times the curvature; equilateral ones have h² = 4 / √3 of their
// area.
TEST(DecimatedSource, RegistersADenseSourceCloserThanFlatFaces) {
  constexpr double width = 0.1;
  const TriangleMesh source = shapes::moved(
      shapes::icosphere(6), {Vector3(width, width, 1).asDiagonal().toDenseMatrix(), Vector3::Zero()});
  const TriangleMesh target{bent(source.vertices), source.faces};
  Anchors anchors;
  const Points places = shapes::icosphere(1).vertices;
  for (const auto& place : places.colwise()) {
    const Vector3 x(width * place.x(), width * place.y(), place.z());
    anchors.pairs.push_back({"", x, bent(x)});
  }
  FitOptions options;
  options.lambda = 0.2;
  const Registration registration = register_models({source, target, anchors}, options);
  const std::size_t leading = registration.summary.leading_vertices;
  ASSERT_GT(leading, 0u);
  ASSERT_EQ(registration.confidence.size(), static_cast<std::size_t>(source.vertices.cols()));
  const Points registered = registered_vertices(registration);
  ASSERT_EQ(registered.cols(), source.vertices.cols());
  const ClosestPointTree surface(target);
  std::vector<double> distances;
  for (const auto& x : registered.colwise())
    distances.push_back(std::sqrt(surface.closest(x)->squared_distance));
  const double faces = 2 * static_cast<double>(leading);
  const double squared_edge = 4 / std::sqrt(3.0) * vertex_areas(target).sum() / faces;
  EXPECT_LT(summarize(distances).p95, squared_edge / 8 / width);
}

}  // namespace
}  // namespace bespoke
