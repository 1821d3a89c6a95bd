#include "bespoke/clearance/keep_clear.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "bespoke/clearance/detail/face_passages.h"
#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/quality/self_intersection.h"
#include "clearance/balls.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

constexpr double pole_angle = 0.5;

bool is_met(const ClearanceSummary& summary) { return summary.is_clear() && summary.after.samples == 0; }

/// Edges from the nearest flagged vertex, of every vertex.
std::vector<int> edges_from(const TriangleMesh& mesh, const std::vector<char>& flags) {
  const VertexAdjacency around = vertex_adjacency(mesh);
  std::vector<int> rings(flags.size(), 1000);
  for (std::size_t v = 0; v < flags.size(); ++v)
    if (flags[v]) rings[v] = 0;
  for (int pass = 0; pass < 20; ++pass)
    for (std::size_t v = 0; v < rings.size(); ++v)
      for (int i = around.start[v]; i < around.start[v + 1]; ++i)
        rings[v] = std::min(
            rings[v], rings[static_cast<std::size_t>(around.neighbours[static_cast<std::size_t>(i)])] + 1);
  return rings;
}

TEST(KeepClear, WhatMissesNothingKeepsItsBits) {
  const TriangleMesh product = test::shell(1.05);
  const Points carried = 1.01 * product.vertices;
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {test::unit_ball()});
  EXPECT_EQ(cleared.vertices, carried);
  EXPECT_EQ(cleared.summary.moved, 0u);
  EXPECT_EQ(cleared.summary.before.samples, 0u);
  EXPECT_TRUE(is_met(cleared.summary));
}

TEST(KeepClear, KeepsTheDistanceThatEveryPlaceHad) {
  const TriangleMesh product = test::shell(1.02);
  const Points carried = test::dented(product.vertices, pole_angle, 0.05);
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {test::unit_ball()});
  EXPECT_GT(cleared.summary.before.inside, 100u);
  EXPECT_TRUE(is_met(cleared.summary)) << to_string(cleared.summary);
  for (Eigen::Index v = 0; v < carried.cols(); ++v)
    ASSERT_GT(cleared.vertices.col(v).norm(), 1.02 - 1.01 * test::unit_ball().tolerance) << v;
}

TEST(KeepClear, MovesNothingBeyondFiveEdgesFromWhatMisses) {
  const TriangleMesh product = test::shell(1.02);
  const Points carried = test::dented(product.vertices, pole_angle, 0.05);
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {test::unit_ball()});
  const std::vector<int> rings = edges_from(product, test::near_pole(product.vertices, pole_angle));
  for (std::size_t v = 0; v < rings.size(); ++v) {
    const auto column = static_cast<Eigen::Index>(v);
    if (rings[v] > 5) {
      ASSERT_EQ(cleared.vertices.col(column), carried.col(column)) << v;
    }
  }
  // Of the diagonal of the ball, whose tolerance says its size.
  EXPECT_LE(cleared.summary.largest_bystander, 0.002 * 2 + 1e-12);
}

TEST(KeepClear, GivesTheEaseThatIsRequired) {
  const TriangleMesh product = test::shell(1.01);
  const ClearedProduct cleared =
      keep_clear(PreparedProduct(product), product.vertices, {test::unit_ball({.ease = 0.05})});
  EXPECT_TRUE(is_met(cleared.summary)) << to_string(cleared.summary);
  for (const auto& vertex : cleared.vertices.colwise()) {
    ASSERT_GT(vertex.norm(), 1.05 - 1.01 * test::unit_ball().tolerance);
    ASSERT_LT(vertex.norm(), 1.06);
  }
}

TEST(KeepClear, WhatWasInsideMayStayAsDeep) {
  const TriangleMesh product = test::shell(0.98);
  const ClearedProduct same = keep_clear(PreparedProduct(product), product.vertices, {test::unit_ball()});
  EXPECT_EQ(same.vertices, product.vertices);
  const ClearedProduct deeper =
      keep_clear(PreparedProduct(product), 0.97 * product.vertices, {test::unit_ball()});
  for (const auto& vertex : deeper.vertices.colwise())
    ASSERT_NEAR(vertex.norm(), 0.98, 2 * test::unit_ball().tolerance);
}

// All vertices are outside, but the middles of edges and faces cut through.
TEST(KeepClear, FindsFacesThatCutThroughBetweenTheirVertices) {
  TriangleMesh product = shapes::icosphere(1);
  product.vertices *= 1.25;
  const Points carried = 1.005 / 1.25 * product.vertices;
  const ClearedProduct cleared =
      keep_clear(PreparedProduct(product), carried, {test::unit_ball({.ease = 0.0})});
  EXPECT_GT(cleared.summary.before.samples, 0u);
  EXPECT_TRUE(is_met(cleared.summary)) << to_string(cleared.summary);
}

TEST(KeepClear, ClosedSeamsStayClosed) {
  const TriangleMesh product = shapes::soup(test::shell(1.02, 3));
  const Points carried = test::dented(product.vertices, pole_angle, 0.05);
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {test::unit_ball()});
  EXPECT_TRUE(is_met(cleared.summary));
  for (Eigen::Index a = 0; a < carried.cols(); ++a)
    for (Eigen::Index b = a + 1; b < carried.cols(); ++b)
      if (product.vertices.col(a) == product.vertices.col(b)) {
        ASSERT_EQ(cleared.vertices.col(a), cleared.vertices.col(b));
      }
}

TEST(KeepClear, PartsThatKeepTheirShapeAreShiftedAsAWhole) {
  const TriangleMesh product = test::shell(1.02);
  const Points carried = test::dented(product.vertices, pole_angle, 0.05);
  std::vector<int> parts(static_cast<std::size_t>(carried.cols()), -1);
  const std::vector<char> is_part = test::near_pole(product.vertices, 0.2);
  for (std::size_t v = 0; v < parts.size(); ++v)
    if (is_part[v]) parts[v] = 0;
  const ClearedProduct cleared = keep_clear(PreparedProduct(product, parts), carried, {test::unit_ball()});
  EXPECT_TRUE(is_met(cleared.summary)) << to_string(cleared.summary);
  Vector3 shift = Vector3::Zero();
  for (std::size_t v = 0; v < parts.size(); ++v) {
    if (!is_part[v]) continue;
    const auto column = static_cast<Eigen::Index>(v);
    const Vector3 move = cleared.vertices.col(column) - carried.col(column);
    if (shift.isZero(0)) shift = move;
    ASSERT_LT((move - shift).norm(), 1e-15);
  }
  EXPECT_GT(shift.norm(), 0.04);
}

// A button on a shirt: it shares no vertex with it, and misses nothing itself.
TEST(KeepClear, SmallShellsGoWithWhatTheyLieOn) {
  TriangleMesh cloth = test::shell(1.02);
  TriangleMesh button = shapes::icosphere(2);
  for (auto vertex : button.vertices.colwise())
    vertex = Vector3(0.01 * vertex.x(), 0.01 * vertex.y(), 1.03 + 0.005 * vertex.z());
  const TriangleMesh product = shapes::joined(cloth, button);
  Points carried = product.vertices;
  carried.leftCols(cloth.vertices.cols()) = test::dented(cloth.vertices, pole_angle, 0.04);
  for (auto vertex : carried.rightCols(button.vertices.cols()).colwise()) vertex.z() -= 0.04;
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {test::unit_ball()});
  EXPECT_TRUE(is_met(cleared.summary)) << to_string(cleared.summary);
  for (Eigen::Index v = cloth.vertices.cols(); v < carried.cols(); ++v)
    ASSERT_LT((cleared.vertices.col(v) - product.vertices.col(v)).norm(), 0.004) << v;
}

// A glove as modellers make it: two sheets, thinner than what the inner one is moved by.
TEST(KeepClear, TheTwoSheetsOfAThickOneStayApart) {
  const TriangleMesh inner = test::shell(1.001), outer = test::shell(1.011);
  TriangleMesh product = shapes::joined(outer, inner);
  for (auto face : product.faces.rightCols(inner.faces.cols()).colwise()) std::swap(face[1], face[2]);
  const Points carried = test::dented(product.vertices, pole_angle, 0.03);
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {test::unit_ball()});
  EXPECT_TRUE(is_met(cleared.summary)) << to_string(cleared.summary);
  const Eigen::Index n = outer.vertices.cols();
  for (Eigen::Index v = 0; v < n; ++v)
    ASSERT_GT(cleared.vertices.col(v).norm() - cleared.vertices.col(v + n).norm(), 0.005) << v;
}

// A stiff cup that is too narrow for its ball has no place on it. Off the ball it would miss nothing.
TEST(KeepClear, PartsAreNotPushedOffWhatTheyAreWornOn) {
  const TriangleMesh whole = test::shell(1.02, 3);
  TriangleMesh cup{whole.vertices, Faces(3, 0)};
  for (const auto& face : whole.faces.colwise())
    if ((whole.vertices(2, face[0]) + whole.vertices(2, face[1]) + whole.vertices(2, face[2])) < 0) {
      cup.faces.conservativeResize(3, cup.faces.cols() + 1);
      cup.faces.rightCols<1>() = face;
    }
  const std::vector<int> parts(static_cast<std::size_t>(cup.vertices.cols()), 0);
  Obstacle ball = test::unit_ball();
  const auto distance_of_unit_ball = ball.distance;
  ball.distance = [=](const Points& x) {
    std::vector<double> values = distance_of_unit_ball(x);
    for (double& value : values) value -= 0.1;
    return values;
  };
  const ClearedProduct cleared = keep_clear(PreparedProduct(cup, parts), cup.vertices, {ball});
  EXPECT_LT((cleared.vertices - cup.vertices).colwise().norm().maxCoeff(), 0.21);
  EXPECT_GT(cleared.summary.after.samples, 0u);
  EXPECT_FALSE(cleared.summary.places.empty());
}

/// Two plates 0.04 apart, from which 0.05 is required.
Obstacle narrow_plates() {
  Obstacle plates;
  plates.name = "the plates";
  plates.step = 1e-3;
  plates.tolerance = 1e-4;
  plates.required = [](const SourcePlaces& places) {
    return std::vector<double>(static_cast<std::size_t>(places.points().cols()), 0.05);
  };
  plates.distance = [](const Points& x) {
    std::vector<double> values;
    for (const auto& point : x.colwise()) values.push_back(0.02 - std::abs(point.z()));
    return values;
  };
  return plates;
}

TEST(KeepClear, PlacesWithoutSpaceAreListedAndNotCrumpled) {
  // A sheet between two plates that leave less than it had to each side.
  TriangleMesh product = shapes::square_grid(20);
  const Obstacle plates = narrow_plates();
  const Points carried = product.vertices.colwise() + Vector3(0, 0, 0.01);
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {plates});
  // Nowhere is there 0.05: every sample misses, each counted once.
  EXPECT_EQ(cleared.summary.before.samples, cleared.summary.looked_at);
  EXPECT_EQ(cleared.summary.after.samples, cleared.summary.looked_at);
  ASSERT_FALSE(cleared.summary.places.empty());
  EXPECT_NEAR(cleared.summary.places.front().missing, 0.03, 0.012);
  EXPECT_EQ(cleared.summary.places.front().obstacle, "the plates");
  EXPECT_THAT(to_string(cleared.summary), HasSubstr("no space at"));
  for (const auto& vertex : cleared.vertices.colwise()) ASSERT_LT(std::abs(vertex.z()), 0.05);
  EXPECT_LT(cleared.summary.strain_after.max, 0.1);
  EXPECT_EQ(cleared.summary.new_self_intersections, 0u);
}

// What came into a plate leaves it, although it does not get the distance that it had.
TEST(KeepClear, WhereThereIsLessSpaceThanRequiredNothingStaysInside) {
  const TriangleMesh product = shapes::square_grid(20);
  const Obstacle plates = narrow_plates();
  Points carried = product.vertices;
  for (auto vertex : carried.colwise())
    vertex.z() = 0.04 * std::exp(-50 * (vertex - Vector3(0.5, 0.5, 0)).squaredNorm());
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {plates});
  EXPECT_GT(cleared.summary.before.inside, 100u);
  EXPECT_EQ(cleared.summary.after.inside, 0u) << to_string(cleared.summary);
  EXPECT_TRUE(cleared.summary.is_clear());
}

// Distances are stored in a band: deeper they are all the same.
TEST(KeepClear, WhatLiesDeeperThanTheBandComesOut) {
  const TriangleMesh product = test::shell(1.02, 4);
  Obstacle ball = test::unit_ball();
  const auto distance = ball.distance;
  ball.step = 0.02;
  ball.distance = [=](const Points& x) {
    std::vector<double> values = distance(x);
    for (double& value : values) value = std::clamp(value, -0.06, 0.06);
    return values;
  };
  const Points carried = test::dented(product.vertices, 0.5, 0.14);
  const ClearedProduct cleared = keep_clear(PreparedProduct(product), carried, {ball});
  EXPECT_GT(cleared.summary.before.most, 0.07);
  EXPECT_EQ(cleared.summary.after.inside, 0u) << to_string(cleared.summary);
  EXPECT_LT(cleared.summary.after.most, 0.1 * cleared.summary.before.most);
}

// What lies over a finer layer has its vertices outside of it, and the layer's own pass through its faces.
TEST(KeepClear, FinerLayersDoNotPassThroughCoarserOnes) {
  const TriangleMesh lower = test::shell(1.0, 5), upper = test::shell(1.06, 2);
  const Points lower_after = 1.04 * lower.vertices;
  const Obstacle layer = layer_obstacle("shirt", lower, lower_after, {3.5, 3.5});
  const ClearedProduct cleared = keep_clear(PreparedProduct(upper), upper.vertices, {layer});
  EXPECT_TRUE(cleared.summary.passed_through.empty()) << to_string(cleared.summary);
  TriangleMesh both = shapes::joined({lower_after, lower.faces}, {cleared.vertices, upper.faces});
  EXPECT_TRUE(self_intersections(both).empty());
}

TEST(FacePassages, TellWhereALayerIsPassedThroughThatWasNot) {
  const TriangleMesh lower = shapes::square_grid(20);
  TriangleMesh upper = lower;
  upper.vertices.colwise() += Vector3(0.013, 0.017, 0.01);
  Points lower_after = lower.vertices;
  for (auto vertex : lower_after.colwise()) vertex.z() += vertex.x() < 0.5 ? 0.2 : -0.2;
  const std::vector<Obstacle> layers = {layer_obstacle("shirt", lower, lower_after, {3, 3})};
  FacePassages passages(upper, upper.vertices, layers);
  const FacePairs pairs = passages.found();
  ASSERT_FALSE(pairs.empty());
  EXPECT_TRUE(passages.of_product(pairs).empty());
  const std::vector<PassedThrough> places = passages.places(pairs, 10);
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places.front().other, "shirt");
  EXPECT_EQ(places.front().pairs, pairs.size());
  EXPECT_NEAR(places.front().place.x(), 0.5, 0.1);
  ClearanceSummary summary;
  summary.passed_through = places;
  EXPECT_THAT(to_string(summary), HasSubstr("passes through shirt at ("));
}

TEST(CorrectionSamples, AreConstrainedAndCountedOnce) {
  const TriangleMesh product = test::shell(1.02, 2);
  std::vector<Obstacle> ball = {test::unit_ball({.ease = 0.1})};
  ball.front().short_is_breach = true;
  const Eigen::Matrix2Xi no_lines(2, 0);
  SampleDistances distances({constraint_samples(product, no_lines, 0.1), product}, ball),
      checks({check_samples(product, no_lines, 0.1), product}, ball);
  const Eigen::Index constrained = distances.samples().count(), checked = checks.samples().count();
  CorrectionSamples samples(distances, checks);
  distances.look(product.vertices);
  checks.look(product.vertices);
  for (int round = 0; round < 3; ++round) {
    EXPECT_TRUE(samples.constrain_what_misses());
    EXPECT_EQ(distances.samples().count(), constrained + checked) << round;
    EXPECT_EQ(samples.count().samples, static_cast<std::size_t>(constrained + checked)) << round;
    EXPECT_EQ(samples.count().breaches, samples.count().samples) << round;
  }
}

TEST(FacePassages, CountThePairsWithEachLayer) {
  // A wall through the ground from the start, and one that stands above it and comes down to the same place.
  const TriangleMesh ground = shapes::square_grid(8);
  TriangleMesh wall = shapes::square_grid(8);
  for (auto vertex : wall.vertices.colwise()) vertex = Vector3(0.43, vertex.x(), vertex.y() - 0.52);
  TriangleMesh raised = wall;
  raised.vertices.row(2).array() += 1;
  const std::vector<Obstacle> layers = {layer_obstacle("through", wall, wall.vertices, {3, 3}),
                                        layer_obstacle("above", raised, wall.vertices, {3, 3})};
  FacePassages passages(ground, ground.vertices, layers);
  const FacePairs pairs = passages.found();
  const std::vector<LayerPairs> counts = passages.of_layers(pairs);
  const std::size_t all = self_intersections(shapes::joined(ground, wall)).size();
  ASSERT_GT(all, 0u);
  ASSERT_EQ(counts.size(), 2u);
  EXPECT_EQ(counts[0].before, all);
  EXPECT_EQ(counts[0].after, 0u);
  EXPECT_EQ(counts[1].before, 0u);
  EXPECT_EQ(counts[1].after, all);
}

// A sock touches on purpose; a strap is thinner than a voxel.
TEST(KeepClear, WhatTouchesOrIsThinIsKeptOutside) {
  const TriangleMesh sock = test::shell(1.0);
  const ClearedProduct touching =
      keep_clear(PreparedProduct(sock), test::dented(sock.vertices, pole_angle, 0.01), {test::unit_ball()});
  EXPECT_TRUE(is_met(touching.summary)) << to_string(touching.summary);
  TriangleMesh strap = shapes::square_grid(40);
  strap.vertices.row(0).array() -= 0.5;
  strap.vertices.row(1) = 0.01 * (strap.vertices.row(1).array() - 0.5);
  for (auto vertex : strap.vertices.colwise())
    vertex.z() = std::sqrt(1.002 * 1.002 - vertex.x() * vertex.x() - vertex.y() * vertex.y());
  const ClearedProduct thin =
      keep_clear(PreparedProduct(strap), test::dented(strap.vertices, pole_angle, 0.01), {test::unit_ball()});
  EXPECT_TRUE(is_met(thin.summary)) << to_string(thin.summary);
}

TEST(KeepClear, PointsWithoutFacesMoveAlone) {
  const TriangleMesh points{test::shell(1.02).vertices, Faces(3, 0)};
  const Points carried = test::dented(points.vertices, pole_angle, 0.05);
  const ClearedProduct cleared = keep_clear(PreparedProduct(points), carried, {test::unit_ball()});
  EXPECT_TRUE(is_met(cleared.summary));
  for (Eigen::Index v = 0; v < carried.cols(); ++v) {
    ASSERT_GT(cleared.vertices.col(v).norm(), 1.02 - 1.01 * test::unit_ball().tolerance);
    ASSERT_LT(cleared.vertices.col(v).norm(), 1.02 + 1e-3);
  }
}

TEST(KeepClear, SameBitsEveryTime) {
  const TriangleMesh product = test::shell(1.02);
  const Points carried = test::dented(product.vertices, pole_angle, 0.05);
  const PreparedProduct prepared(product);
  EXPECT_EQ(keep_clear(prepared, carried, {test::unit_ball()}).vertices,
            keep_clear(PreparedProduct(product), carried, {test::unit_ball()}).vertices);
}

TEST(KeepClear, RefusesSizesThatDifferAndWhatIsNotFinite) {
  const TriangleMesh product = test::shell(1.02, 1);
  const PreparedProduct prepared(product);
  EXPECT_THROW(keep_clear(prepared, Points(3, 2), {}), InvalidInput);
  Points carried = product.vertices;
  carried(0, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(keep_clear(prepared, carried, {}), InvalidInput);
  TriangleMesh bad = product;
  bad.faces(0, 0) = 1000;
  EXPECT_THROW(PreparedProduct{bad}, InvalidInput);
  EXPECT_THROW(PreparedProduct(product, std::vector<int>(3)), InvalidInput);
  EXPECT_THROW(PreparedProduct(TriangleMesh{Points(3, 0), Faces(3, 0)}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
