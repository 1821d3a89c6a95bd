#include "bespoke/anchors/anchor_scale.h"

#include <gmock/gmock.h>

#include <random>

#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A body of sorts that stands on the origin.
TriangleMesh standing_body() {
  TriangleMesh body = shapes::icosphere(3);
  for (auto vertex : body.vertices.colwise())
    vertex = Vector3(0.3 * vertex[0] * (1.2 + vertex[2]), 0.2 * vertex[1], 0.9 + 0.9 * vertex[2]);
  return body;
}

Points some_vertices(const TriangleMesh& mesh, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<Eigen::Index> vertex(0, mesh.vertices.cols() - 1);
  Points points(3, count);
  for (int i = 0; i < count; ++i) points.col(i) = mesh.vertices.col(vertex(random));
  return points;
}

TEST(AnchorScale, IsTheFactorByWhichTheModelWasScaled) {
  const TriangleMesh body = standing_body();
  for (const double scale : {0.001, 0.01, 0.1, 1 / 2.54, 2.54, 4.0, 10.0, 25.4, 100.0, 1000.0})
    for (const unsigned seed : {1u, 2u}) {
      TriangleMesh scaled = body;
      scaled.vertices *= scale;
      const std::optional<double> found = anchor_scale(scaled, some_vertices(body, 15, seed));
      ASSERT_TRUE(found) << scale << " " << seed;
      EXPECT_NEAR(*found / scale, 1, 0.01) << scale << " " << seed;
    }
}

TEST(AnchorScale, IsNoneForAnchorsOnBesideAndInsideTheModel) {
  const TriangleMesh body = standing_body();
  const Vector3 middle(0, 0, 0.9);
  for (const unsigned seed : {1u, 2u, 3u}) {
    const Points on = some_vertices(body, 15, seed);
    EXPECT_EQ(anchor_scale(body, on), std::nullopt);
    const Points joints = (0.6 * (on.colwise() - middle)).colwise() + middle;
    EXPECT_EQ(anchor_scale(body, joints), std::nullopt) << seed;
    const Points larger = 1.3 * on;  // a size, no unit
    EXPECT_EQ(anchor_scale(body, larger), std::nullopt) << seed;
  }
  EXPECT_EQ(anchor_scale(body, Points(3, 0)), std::nullopt);
  EXPECT_EQ(anchor_scale(body, 10 * some_vertices(body, 3, 1)), std::nullopt);
}

TEST(AnchorScale, OfTheCornersOfABoxIsNone) {
  const TriangleMesh ball = shapes::icosphere(3);
  Points corners(3, 8);
  for (int i = 0; i < 8; ++i) corners.col(i) = Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  EXPECT_EQ(anchor_scale(ball, corners), std::nullopt);
}

TEST(AnchorScale, IsNamedOnEitherSide) {
  const TriangleMesh body = standing_body();
  TriangleMesh inches = body;
  inches.vertices *= 2.54;
  Anchors anchors;
  const Points on = some_vertices(body, 12, 7);
  for (const auto& place : on.colwise()) anchors.pairs.push_back({"", place, place});
  const auto refusal = [&](const TriangleMesh& source, const TriangleMesh& target) {
    return test::error_message<InvalidInput>([&] { require_anchors_at_scale(anchors, source, target); });
  };
  EXPECT_EQ(refusal(body, body), "accepted");
  EXPECT_THAT(refusal(inches, body), AllOf(HasSubstr("do not lie on the source"), HasSubstr("by 2.54")));
  EXPECT_THAT(refusal(body, inches), AllOf(HasSubstr("do not lie on the target"), HasSubstr("\"b\"")));
}

TEST(AnchorScale, ScalesAllThatHasALength) {
  Anchors anchors;
  anchors.pairs = {{"p", Vector3(1, 2, 3), Vector3(4, 5, 6)}};
  anchors.pairs[0].sigma = 0.5;
  anchors.curves = {{"c", Points::Ones(3, 2), Points::Ones(3, 2)}};
  anchors.patches.resize(1);
  anchors.patches[0].a.border = Points::Ones(3, 4);
  scale_anchors(anchors, 10, 100);
  EXPECT_EQ(anchors.pairs[0].a, Vector3(10, 20, 30));
  EXPECT_EQ(anchors.pairs[0].b, Vector3(400, 500, 600));
  EXPECT_EQ(anchors.pairs[0].sigma, 50);
  EXPECT_EQ(anchors.curves[0].a(0, 0), 10);
  EXPECT_EQ(anchors.curves[0].b(0, 0), 100);
  EXPECT_EQ(anchors.patches[0].a.border(2, 3), 10);
}

}  // namespace
}  // namespace bespoke
