#include "bespoke/registration/unmet_vertices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bespoke/pipeline/fit_mapping.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr double satisfied_within = 1e-3;

FittedMapping carried_to(const TriangleMesh& source, const Points& fitted, ElasticMethod method) {
  FitOptions options;
  options.elastic = method;
  options.lambda = 0.4;
  options.fit_tolerance = satisfied_within;
  const TriangleMesh registered{fitted, source.faces};
  return fit_mapping({source, registered, {}, &registered}, options);
}

/// Every vertex beyond the tolerance is listed with its residual, and no other.
void expect_complete(const FittedMapping& fit, const TriangleMesh& source) {
  const Points offset = (*fit.elastic)(source.vertices) - fit.fitted_vertices;
  std::size_t listed = 0;
  for (Eigen::Index i = 0; i < offset.cols(); ++i) {
    if (!(offset.col(i).norm() > satisfied_within)) continue;
    ASSERT_LT(listed, fit.summary.elastic.unmet.size());
    EXPECT_EQ(fit.summary.elastic.unmet[listed].vertex, i);
    EXPECT_NEAR(fit.summary.elastic.unmet[listed].residual, offset.col(i).norm(), 1e-12);
    ++listed;
  }
  EXPECT_EQ(listed, fit.summary.elastic.unmet.size());
}

TEST(UnmetVertices, AreNoneWhereTheMapMeetsTheFit) {
  const TriangleMesh source = shapes::icosphere(3);
  Points fitted = source.vertices;
  fitted.row(0) += (0.1 * (3 * fitted.row(1).array()).sin()).matrix();
  const FittedMapping fit = carried_to(source, fitted, ElasticMethod::diffeomorphic);
  EXPECT_THAT(fit.summary.elastic.unmet, IsEmpty());
  EXPECT_EQ(to_string(fit.summary.elastic.unmet), "");
  expect_complete(fit, source);
}

TEST(UnmetVertices, AreFoldedWhereTheFittedFacesAre) {
  // A disc of the sheet is mirrored within its plane, which turns its faces over.
  constexpr double radius = 0.25;
  const TriangleMesh source = shapes::square_grid(32);
  Points fitted = source.vertices;
  const auto distance = [&](int i) { return (source.vertices.col(i) - Vector3(0.5, 0.5, 0)).norm(); };
  for (int i = 0; i < fitted.cols(); ++i)
    if (distance(i) < radius) fitted(0, i) = 1 - fitted(0, i);
  const FittedMapping fit = carried_to(source, fitted, ElasticMethod::diffeomorphic);
  expect_complete(fit, source);
  int folded = 0;
  for (const UnmetVertex& unmet : fit.summary.elastic.unmet) {
    if (distance(unmet.vertex) > radius + 0.1) {
      EXPECT_NE(unmet.reason, UnmetReason::folded);
    }
    if (unmet.reason == UnmetReason::folded) ++folded;
  }
  EXPECT_GT(folded, 20);
  EXPECT_THAT(to_string(fit.summary.elastic), HasSubstr("fitted faces folded"));
}

TEST(UnmetVertices, ShareAPlaceThatIsTornApart) {
  const TriangleMesh once = shapes::square_grid(4);
  const TriangleMesh source = shapes::joined(once, once);
  Points fitted = source.vertices;
  fitted.rightCols(once.vertices.cols()).row(2).array() += 0.1;
  const FittedMapping fit = carried_to(source, fitted, ElasticMethod::diffeomorphic);
  expect_complete(fit, source);
  EXPECT_EQ(fit.summary.elastic.unmet.size(), std::size_t(source.vertices.cols()));
  for (const UnmetVertex& unmet : fit.summary.elastic.unmet) {
    EXPECT_EQ(unmet.reason, UnmetReason::shared_place);
    EXPECT_NEAR(unmet.residual, 0.05, 1e-9);
  }
}

TEST(UnmetVertices, AreSteepWhereSheetsPartThatAlmostTouch) {
  const TriangleMesh once = shapes::square_grid(8);
  const TriangleMesh other = shapes::moved(once, {Matrix3::Identity(), Vector3(0, 0, 1e-7)});
  const TriangleMesh source = shapes::joined(once, other);
  Points fitted = source.vertices;
  fitted.rightCols(once.vertices.cols()).row(2).array() += 0.1;
  const FittedMapping fit = carried_to(source, fitted, ElasticMethod::diffeomorphic);
  expect_complete(fit, source);
  EXPECT_FALSE(fit.summary.elastic.unmet.empty());
  for (const UnmetVertex& unmet : fit.summary.elastic.unmet) EXPECT_EQ(unmet.reason, UnmetReason::steep);
}

TEST(UnmetVertices, LeaveOutVerticesOfNoFace) {
  TriangleMesh source = shapes::triangle();
  source.vertices.conservativeResize(3, 4);
  source.vertices.col(3) = Vector3(1, 1, 1);
  Points away = source.vertices;
  away.col(3) += Vector3(1, 0, 0);
  EXPECT_THAT(unmet_vertices(source, source.vertices, away, satisfied_within), IsEmpty());
}

TEST(UnmetVertices, PrintOneLine) {
  const std::vector<UnmetVertex> unmet = {
      {3, 0.1, UnmetReason::folded}, {5, 0.2, UnmetReason::steep}, {8, 0.1, UnmetReason::folded}};
  EXPECT_EQ(to_string(unmet), "3 vertices unmet: 2 fitted faces folded, 1 too steep");
}

// A ball that is placed into its neighbour: with a gap the map is met elsewhere, and says where and why.
TEST(UnmetVertices, AreTouchingWhereTheTargetTouchesItself) {
  const TriangleMesh ball = shapes::icosphere(3);
  const auto two_balls = [&](double apart) {
    return shapes::joined(ball, shapes::moved(ball, {Matrix3::Identity(), Vector3(apart, 0.13, -0.07)}));
  };
  const TriangleMesh source = two_balls(2.3), touching = two_balls(1.95);
  FitOptions options;
  options.lambda = 0.4;
  options.fit_tolerance = satisfied_within;
  options.contact_offset = 0.02;
  const FittedMapping fit = fit_mapping({source, touching, {}, &touching}, options);
  ASSERT_TRUE(fit.summary.contact.has_value());
  EXPECT_EQ(fit.summary.contact->left, 0u);
  const Points wanted = inverse(fit.target_from_source) * touching.vertices;
  const Points images = (*fit.elastic)(source.vertices);
  int listed = 0;
  for (const UnmetVertex& unmet : fit.summary.elastic.unmet) {
    if (unmet.reason != UnmetReason::touching) continue;
    ++listed;
    EXPECT_NEAR(unmet.residual, (images.col(unmet.vertex) - wanted.col(unmet.vertex)).norm(), 1e-12);
  }
  EXPECT_GT(listed, 0);
}

}  // namespace
}  // namespace bespoke
