#include "bespoke/clearance/obstacle.h"

#include <gtest/gtest.h>

#include "asset/small_asset.h"
#include "bespoke/clearance/keep_clear.h"
#include "bespoke/clearance/model_sides.h"
#include "bespoke/error.h"
#include "clearance/balls.h"

namespace bespoke {
namespace {

constexpr ModelSizes ball_sizes{3.5, 3.5};

/// Of a map from the unit sphere to itself.
std::shared_ptr<const ModelDistances> ball_distances() {
  static const auto distances = [] {
    const TriangleMesh ball = test::shell(1, 5);
    return model_distances(with_model_sides(with_preview(test::small_asset(), ball), ball, ball));
  }();
  return distances;
}

Points on_axis(double x) { return Vector3(x, 0, 0); }

TEST(BodyObstacle, KeepRequiresTheDistanceOnTheSource) {
  const auto distances = ball_distances();
  const Obstacle body = body_obstacle(distances, ball_sizes, {});
  const double exact = 1e-3;
  EXPECT_NEAR(body.required(on_axis(1.04)).front(), 0.04, exact);
  EXPECT_NEAR(body.required(on_axis(0.97)).front(), -0.03, exact);
  EXPECT_NEAR(body.distance(on_axis(1.02)).front(), 0.02, exact);
  EXPECT_LT(body.with_uncertainty(on_axis(1.02)).uncertainty.front(), exact);
  // Far away the band is all that is known.
  EXPECT_NEAR(body.required(on_axis(2)).front(), 0.9 * distances->target.band(), exact);
}

TEST(BodyObstacle, LengthsFollowThePowerOfTwoOfTheSizes) {
  const Obstacle body = body_obstacle(ball_distances(), {3.5, 7.5}, {});
  EXPECT_NEAR(body.required(on_axis(1.03)).front(), 0.06, 2e-3);
}

TEST(BodyObstacle, EaseIsTheSameEverywhere) {
  const Obstacle body = body_obstacle(ball_distances(), ball_sizes, {.ease = 0.02});
  for (const double x : {0.9, 1.0, 1.01, 3.0}) EXPECT_NEAR(body.required(on_axis(x)).front(), 0.02, 1e-9);
}

TEST(BodyObstacle, RefusesMoreEaseThanTheBandCanTell) {
  EXPECT_THROW(body_obstacle(ball_distances(), ball_sizes, {.ease = 0.5}), InvalidInput);
}

TEST(SourcePlaces, AreLookedUpOnceInGridsThatAreTheSame) {
  int times_made = 0;
  const Points x = test::shell(1.02, 2).vertices;
  const SourcePlaces places([&] {
    ++times_made;
    return x;
  });
  const TriangleMesh ball = test::shell(1, 4), larger = test::shell(1.01, 4);
  const auto of = [](const TriangleMesh& mesh) {
    return model_distances(with_model_sides(with_preview(test::small_asset(), mesh), mesh, mesh))->source;
  };
  const DistanceGrid grid = of(ball), same = of(ball), other = of(larger);
  EXPECT_EQ(places.distances(grid), grid(x));
  EXPECT_EQ(places.distances(same), grid(x));
  EXPECT_EQ(times_made, 1);
  EXPECT_EQ(places.distances(other), other(x));
  EXPECT_EQ(times_made, 2);
}

TEST(LayerObstacle, KeepsOrderAndDistance) {
  const TriangleMesh lower = test::shell(1.02, 3), upper = test::shell(1.04, 4);
  // The lower layer was corrected outwards, through the upper one.
  const Points lower_after = 1.05 / 1.02 * lower.vertices;
  const Obstacle layer = layer_obstacle("shirt", lower, lower_after, ball_sizes);
  const ClearedProduct cleared = keep_clear(PreparedProduct(upper), upper.vertices, {layer});
  EXPECT_TRUE(cleared.summary.is_clear() && cleared.summary.after.samples == 0) << to_string(cleared.summary);
  for (const auto& vertex : cleared.vertices.colwise()) ASSERT_GT(vertex.norm(), 1.065);
}

TEST(LayerObstacle, RequiresNothingOfWhatIsUnderIt) {
  const TriangleMesh lower = test::shell(1.02, 3);
  const Obstacle layer = layer_obstacle("shirt", lower, lower.vertices, ball_sizes);
  EXPECT_EQ(layer.planes(on_axis(1)).required.front(), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(layer.planes(on_axis(3)).required.front(), -std::numeric_limits<double>::infinity());
}

// The target presses two limbs together, so that each is nearer to what lies on the other.
TEST(LayerObstacle, TakesTheSheetThatWasNearest) {
  TriangleMesh left = test::shell(1), right = left;
  left.vertices.row(0).array() -= 1.1;
  right.vertices.row(0).array() += 1.1;
  const TriangleMesh lower = shapes::joined(left, right);
  Points after = lower.vertices;
  after.rightCols(right.vertices.cols()).row(0).array() -= 0.18;
  const Obstacle layer = layer_obstacle("shirt", lower, after, ball_sizes);
  const Vector3 place(-0.085, 0, 0);
  const SidePlanes planes = layer.planes(place);
  // On the target the other limb's surface is at x = -0.08.
  EXPECT_NEAR(planes.required.front(), 0.015, 1e-3);
  EXPECT_NEAR(planes.normals.col(0).dot(place - planes.origins.col(0)), 0.015, 1e-3);
}

TEST(BodyAttraction, DrawsPlacesBackThatCameFarther) {
  const TriangleMesh product = test::shell(1.02);
  const auto distances = ball_distances();
  Points carried = product.vertices;
  for (auto vertex : carried.colwise())
    if (vertex.z() > 0.9) vertex *= 1.005;
  const Obstacle ball = body_obstacle(distances, ball_sizes, {}),
                 back = body_attraction(distances, ball_sizes);
  const ClearedProduct kept = keep_clear(PreparedProduct(product), carried, {ball});
  const ClearedProduct drawn = keep_clear(PreparedProduct(product), carried, {ball, back});
  EXPECT_TRUE(drawn.summary.is_clear());
  EXPECT_EQ(drawn.summary.after.samples, kept.summary.after.samples);
  EXPECT_GT(drawn.summary.moved, kept.summary.moved);
  for (Eigen::Index v = 0; v < carried.cols(); ++v) {
    ASSERT_LE((drawn.vertices.col(v) - kept.vertices.col(v)).norm(), 2 * 0.002 * 3.5 + 1e-12);
  }
  // 0.5 % of the radius is 0.14 % of the diagonal, of which 0.1 % may remain.
  EXPECT_LT(drawn.vertices.colwise().norm().maxCoeff(), 1.02 + 0.001 * 3.5 + 2 * ball.tolerance);
}

}  // namespace
}  // namespace bespoke
