#include "bespoke/alignment/geodesic_counterparts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr int sheet_columns = 40;
constexpr double sheet_length = 4;
constexpr double column_width = sheet_length / sheet_columns;

/// A sheet of 4 × 1, flat.
TriangleMesh sheet() {
  TriangleMesh mesh = shapes::square_grid(sheet_columns);
  mesh.vertices.row(0) *= sheet_length;
  return mesh;
}

/// Where rolling the sheet up takes its points: every column of squares stays flat and turns by a little
/// against the one before, so that no distance along the sheet changes.
Points rolled(const Points& x) {
  constexpr double turn = 0.1;  // radians a column: 4 together
  Points result = x;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    Vector3 place(0, x(1, i), 0);
    for (int column = 0; column < sheet_columns; ++column) {
      const double part = std::clamp(x(0, i) - column * column_width, 0.0, column_width);
      place += part * Vector3(std::cos(turn * column), 0, std::sin(turn * column));
    }
    result.col(i) = place;
  }
  return result;
}

/// Not in a row, near one end.
Points sheet_pairs() {
  Points x(3, 4);
  x << 0, 0.2, 0.7, 0.5,   //
      0.1, 0.9, 0.4, 0.8,  //
      0, 0, 0, 0;
  return x;
}

void expect_rolled(const GeodesicCounterparts& found, double scale) {
  ASSERT_GE(found.sources.cols(), 5);
  EXPECT_GT(found.sources.row(0).maxCoeff(), sheet_length - column_width);  // the far end first
  const Points expected = scale * rolled(found.sources);
  for (Eigen::Index k = 0; k < expected.cols(); ++k)
    EXPECT_LT((found.targets.col(k) - expected.col(k)).norm(), scale * column_width);
}

TEST(GeodesicCounterparts, FollowASheetThatIsRolledUp) {
  const TriangleMesh flat = sheet();
  expect_rolled(geodesic_counterparts(flat, {rolled(flat.vertices), flat.faces},
                                      {sheet_pairs(), rolled(sheet_pairs())}),
                1);
}

TEST(GeodesicCounterparts, FollowATargetOfAnotherSize) {
  const TriangleMesh flat = sheet();
  const GeodesicCounterparts found = geodesic_counterparts(flat, {30 * rolled(flat.vertices), flat.faces},
                                                           {sheet_pairs(), 30 * rolled(sheet_pairs())});
  expect_rolled(found, 30);
}

TEST(GeodesicCounterparts, LeaveOutWhatTheTargetLacks) {
  const TriangleMesh flat = sheet();
  TriangleMesh half = flat;
  half.vertices.row(0) /= 4;  // ends at the pairs
  Points on_half = sheet_pairs();
  on_half(0, 2) = 0.7;
  const GeodesicCounterparts found = geodesic_counterparts(flat, half, {sheet_pairs(), on_half});
  for (Eigen::Index k = 0; k < found.sources.cols(); ++k) EXPECT_LT(found.sources(0, k), 1.6);
}

TEST(GeodesicCounterparts, AreNotLookedForNearPairs) {
  const TriangleMesh flat = sheet();
  Points everywhere(3, 16);
  for (int k = 0; k < 16; ++k) everywhere.col(k) << 0.5 * (k / 2) + 0.2, k % 2, 0;
  EXPECT_EQ(geodesic_counterparts(flat, flat, {everywhere, everywhere}).sources.cols(), 0);
}

TEST(GeodesicCounterparts, DoNotLeaveTheComponentOfThePairs) {
  const TriangleMesh flat = sheet();
  TriangleMesh beside = flat;
  beside.vertices.row(2).array() += 0.01;
  const TriangleMesh both = shapes::joined(flat, beside);
  const GeodesicCounterparts found = geodesic_counterparts(both, both, {sheet_pairs(), sheet_pairs()});
  ASSERT_GT(found.sources.cols(), 0);
  EXPECT_EQ(found.sources.row(2).cwiseAbs().maxCoeff(), 0);
  EXPECT_EQ(found.targets.row(2).cwiseAbs().maxCoeff(), 0);
}

/// Both sides of a slit lie at the same places, and are far from each other along the sheet.
TEST(GeodesicCounterparts, DoNotTouchPairsAcrossASlit) {
  TriangleMesh slit = sheet();
  const auto whole = static_cast<int>(slit.vertices.cols());
  std::vector<int> copy(static_cast<std::size_t>(whole));
  for (int i = 0; i < whole; ++i) {
    copy[static_cast<std::size_t>(i)] = i;
    if (std::abs(slit.vertices(1, i) - 0.5) > 1e-9 || slit.vertices(0, i) < 1) continue;
    copy[static_cast<std::size_t>(i)] = static_cast<int>(slit.vertices.cols());
    slit.vertices.conservativeResize(3, slit.vertices.cols() + 1);
    slit.vertices.rightCols(1) = slit.vertices.col(i);
  }
  for (auto&& face : slit.faces.colwise()) {
    const Vector3 middle = slit.vertices(Eigen::all, face).rowwise().mean();
    if (middle[1] > 0.5)
      for (int& vertex : face) vertex = copy[static_cast<std::size_t>(vertex)];
  }
  Points pairs = sheet_pairs();
  pairs.col(3) << 3.7, 0.5, 0;
  const GeodesicCounterparts found = geodesic_counterparts(slit, slit, {pairs, pairs});
  ASSERT_GT(found.sources.cols(), 0);
  for (const auto& x : found.sources.colwise())
    EXPECT_GT((pairs.colwise() - x).colwise().norm().minCoeff(), 0.01 * diagonal(slit.vertices));
}

TEST(GeodesicCounterparts, AreNoneWithoutPairs) {
  EXPECT_EQ(geodesic_counterparts(sheet(), sheet(), {Points(3, 0), Points(3, 0)}).sources.cols(), 0);
  EXPECT_THROW(geodesic_counterparts(sheet(), sheet(), {Points::Zero(3, 2), Points::Zero(3, 3)}),
               InvalidInput);
}

}  // namespace
}  // namespace bespoke
