#include "bespoke/surface_fit/matching/plane_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr NodeLevel every_vertex{1, 1, 100000, 100000};

/// Pairs between two surfaces whose vertices all represent their areas.
std::vector<PlanePair> pairs_between(const TriangleMesh& source, const TriangleMesh& target,
                                     const NodeLevel& level = every_vertex) {
  const TargetSurface from(source), to(target);
  return find_plane_pairs({from, to, from.areas(), to.areas()}, level, {});
}

double total_weight(const std::vector<PlanePair>& pairs) {
  double sum = 0;
  for (const PlanePair& pair : pairs) sum += pair.weight;
  return sum;
}

TEST(PlanePairs, OfASurfaceWithItselfAreItsOwnPlaces) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const auto pairs = pairs_between(sphere, sphere);
  EXPECT_EQ(pairs.size(), 2 * static_cast<std::size_t>(sphere.vertices.cols()));
  for (const PlanePair& pair : pairs) {
    EXPECT_TRUE(pair.point.isApprox(sphere.vertices.col(pair.vertex), 1e-12));
    EXPECT_TRUE(pair.normal.isApprox(vertex_normals(sphere).col(pair.vertex), 1e-12));
  }
  const double area = vertex_areas(sphere).sum();
  EXPECT_NEAR(total_weight(pairs), (1 + NodeFitSettings{}.back_share) * area, 1e-9 * area);
}

TEST(PlanePairs, OfAMovedPlaneAskForTheMoveBothWays) {
  const TriangleMesh square = shapes::square_grid(6);
  const TriangleMesh lifted = shapes::moved(square, {Matrix3::Identity(), Vector3(0, 0, 0.05)});
  std::size_t back = 0;
  for (const PlanePair& pair : pairs_between(square, lifted)) {
    const Vector3 offset = pair.point - square.vertices.col(pair.vertex);
    EXPECT_NEAR(offset.dot(pair.normal), 0.05, 1e-12);
    back += std::abs(pair.weight / TargetSurface(square).areas()[pair.vertex] - 0.5) < 1e-9 ? 1 : 0;
  }
  EXPECT_EQ(back, 25u);  // the inner vertices; those on the rim find the other's boundary
}

TEST(PlanePairs, OfAFewSamplesWeighAsMuchAsThoseOfAll) {
  const TriangleMesh sphere = shapes::icosphere(4);
  const auto all = pairs_between(sphere, sphere), few = pairs_between(sphere, sphere, {1, 1, 400, 200});
  EXPECT_LE(few.size(), 600u);
  EXPECT_NEAR(total_weight(few), total_weight(all), 0.05 * total_weight(all));
}

TEST(PlanePairs, AreNoneWhereNothingIsNear) {
  const TriangleMesh sphere = shapes::icosphere(2);
  EXPECT_TRUE(pairs_between(sphere, shapes::moved(sphere, {Matrix3::Identity(), Vector3(9, 0, 0)})).empty());
}

/// A valley along y with the bottom at x = 0.5, z = 0 and walls at right angles.
TriangleMesh valley() {
  TriangleMesh mesh = shapes::square_grid(10);
  for (auto&& x : mesh.vertices.colwise()) x.z() = std::abs(x.x() - 0.5);
  return mesh;
}

/// The largest crease of pairs between a valley and the plate over it, either way; `more` lies in the valley.
double largest_crease(bool valley_is_source, const TriangleMesh& more = {}) {
  const TriangleMesh plate =
      shapes::moved(shapes::square_grid(10), {Matrix3::Identity(), Vector3(0, 0, 0.1)});
  const TriangleMesh bent = more.faces.cols() == 0 ? valley() : shapes::joined(valley(), more);
  double largest = 0;
  for (const PlanePair& pair : valley_is_source ? pairs_between(bent, plate) : pairs_between(plate, bent))
    largest = std::max(largest, pair.outlier_scale_gain);
  return largest;
}

TEST(PlanePairs, AreCreasedAtTheBottomOfAValleyOfEitherSurface) {
  EXPECT_NEAR(largest_crease(true), 0.25, 1e-12);
  EXPECT_NEAR(largest_crease(false), 0.25, 1e-12);
}

TEST(PlanePairs, AreNotCreasedWhereAnotherSheetIsTheCounterpart) {
  const TriangleMesh sheet =
      shapes::moved(shapes::square_grid(10), {Matrix3::Identity(), Vector3(0, 0, 0.0999)});
  EXPECT_LT(largest_crease(true, sheet), 1e-6);
}

/// The scale gains of pairs between a plate and one above it, or below, both ways, given the certainty of the
/// source's pose.
std::vector<double> scale_gains(double source_height, double certainty) {
  const TriangleMesh plate = shapes::square_grid(6);
  const TargetSurface from(shapes::moved(plate, {Matrix3::Identity(), Vector3(0, 0, source_height)})),
      to(plate);
  const Eigen::VectorXd certainties = Eigen::VectorXd::Constant(plate.vertices.cols(), certainty);
  std::vector<double> found;
  for (const PlanePair& pair :
       find_plane_pairs({from, to, from.areas(), to.areas(), &certainties}, every_vertex, {}))
    found.push_back(pair.outlier_scale_gain);
  return found;
}

TEST(PlanePairs, OfABentSourceOutsideHaveTheScaleGainOfItsCertainty) {
  const std::vector<double> above = scale_gains(0.05, 0.7), below = scale_gains(-0.05, 0.7);
  ASSERT_EQ(above.size(), 50u);
  ASSERT_EQ(below.size(), 50u);
  for (const double outlier_scale_gain : above) EXPECT_NEAR(outlier_scale_gain, 0.7, 1e-12);
  for (const double outlier_scale_gain : below) EXPECT_NEAR(outlier_scale_gain, 0, 1e-12);
}

// Two sheets close to each other, which have changed places on the target.
TEST(PlanePairs, StayWithinTheirPatches) {
  const TriangleMesh sheet = shapes::square_grid(6);
  const auto sheets = [&](double first, double second) {
    return shapes::joined(shapes::moved(sheet, {Matrix3::Identity(), Vector3(0, 0, first)}),
                          shapes::moved(sheet, {Matrix3::Identity(), Vector3(0, 0, second)}));
  };
  FacePatches patches;
  patches.of_face.assign(static_cast<std::size_t>(2 * sheet.faces.cols()), 0);
  std::fill(patches.of_face.begin() + sheet.faces.cols(), patches.of_face.end(), FacePatches::none);
  const TargetSurface from(sheets(0, 0.05), patches), to(sheets(0.05, 0), patches);
  const auto pairs = find_plane_pairs({from, to, from.areas(), to.areas()}, every_vertex, {});
  EXPECT_EQ(pairs.size(), 2 * 2 * 25u);  // the inner vertices of both, both ways
  for (const PlanePair& pair : pairs) {
    const Vector3 x = from.mesh().vertices.col(pair.vertex);
    EXPECT_NEAR((pair.point - x).dot(pair.normal), x.z() < 0.025 ? 0.05 : -0.05, 1e-12);
  }
}

}  // namespace
}  // namespace bespoke
