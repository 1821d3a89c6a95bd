#include "bespoke/surface_fit/contact.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "bespoke/quality/self_intersection.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const Vector3 direction = Vector3(1, 0.13, -0.07).normalized();

/// Two unit balls, `apart` between their centres along `direction`.
TriangleMesh two_balls(double apart) {
  const TriangleMesh ball = shapes::icosphere(3);
  // Not along an axis of symmetry, where edges would meet edges.
  return shapes::joined(ball, shapes::moved(ball, {Matrix3::Identity(), apart * direction}));
}

double min_distance_of_balls(const Points& vertices) {
  const Eigen::Index count = vertices.cols() / 2;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < count; ++i)
    least =
        std::min(least, (vertices.rightCols(count).colwise() - vertices.col(i)).colwise().norm().minCoeff());
  return least;
}

constexpr ContactOptions contact_options{.gap = 0.02, .reach = 0.2};

TEST(SeparateContacts, SeparatesPartsThatPassThroughEachOther) {
  const TriangleMesh source = two_balls(4), fitted = two_balls(1.9);
  ASSERT_FALSE(self_intersections(fitted).empty());
  const ContactFit fit = separate_contacts(source, fitted.vertices, contact_options);
  EXPECT_GT(fit.summary.touching, 0u);
  EXPECT_NEAR(fit.summary.deepest, 0.1, 0.01);
  EXPECT_EQ(fit.summary.left, 0u);
  EXPECT_TRUE(self_intersections({fit.vertices, source.faces}).empty());
  EXPECT_GE(min_distance_of_balls(fit.vertices), 0.95 * contact_options.gap);
  // What lies on the far sides stays.
  const Eigen::Index count = source.vertices.cols() / 2;
  for (Eigen::Index i = 0; i < count; ++i)
    if (source.vertices.col(i).dot(direction) < -0.5) {
      EXPECT_LT((fit.vertices.col(i) - fitted.vertices.col(i)).norm(), 0.1 * contact_options.gap);
    }
}

TEST(SeparateContacts, ReleasesWhatTouchesAndNothingElse) {
  const TriangleMesh source = two_balls(4), fitted = two_balls(2.001);
  const ContactFit fit = separate_contacts(source, fitted.vertices, contact_options);
  EXPECT_EQ(fit.summary.left, 0u);
  EXPECT_FALSE(fit.summary.released.empty());
  for (const ReleasedVertex& released : fit.summary.released) {
    EXPECT_NEAR(fitted.vertices.col(released.vertex).dot(direction), 1, 0.15) << "vertex " << released.vertex;
    EXPECT_EQ(released.place, fitted.vertices.col(released.vertex));
  }
}

TEST(SeparateContacts, LeavesPartsThatAreAsNearOnTheSource) {
  const TriangleMesh source = two_balls(2.01);
  const ContactFit fit = separate_contacts(source, source.vertices, contact_options);
  EXPECT_EQ(fit.summary.touching, 0u);
  EXPECT_EQ(fit.vertices, source.vertices);
}

TEST(SeparateContacts, LeavesTheTwoSidesOfAThinPart) {
  TriangleMesh source = shapes::icosphere(3);
  source.vertices.row(2) *= 0.3;
  TriangleMesh flat = source;
  flat.vertices.row(2) *= 0.03;
  EXPECT_EQ(separate_contacts(source, flat.vertices, contact_options).summary.touching, 0u);
}

// However large the fitted surface: what is near on the source is told by a source as large.
TEST(SeparateContacts, GrowsWithTheFittedSurface) {
  const TriangleMesh near = two_balls(2.01), far = two_balls(4);
  const Points touching = two_balls(1.9).vertices;
  const ContactFit fit = separate_contacts(far, touching, contact_options);
  ASSERT_FALSE(fit.summary.released.empty());
  for (const double size : {0.125, 8.0}) {
    const ContactOptions options{.gap = size * contact_options.gap, .reach = size * contact_options.reach};
    EXPECT_EQ(separate_contacts(near, size * near.vertices, options).summary.touching, 0u);
    const ContactFit scaled = separate_contacts(far, size * touching, options);
    EXPECT_EQ(scaled.summary.touching, fit.summary.touching);
    EXPECT_NEAR((scaled.vertices / size - fit.vertices).cwiseAbs().maxCoeff(), 0, 1e-9);
  }
}

TEST(SeparateContacts, DoesNothingWithoutAGap) {
  const TriangleMesh source = two_balls(4), fitted = two_balls(1.9);
  EXPECT_EQ(separate_contacts(source, fitted.vertices, {.gap = 0}).vertices, fitted.vertices);
}

TEST(SeparateContacts, RefusesWhatCannotBe) {
  const TriangleMesh source = two_balls(4);
  EXPECT_THROW(separate_contacts(source, Points::Zero(3, 5), contact_options), InvalidInput);
  EXPECT_THROW(separate_contacts(source, source.vertices, {.gap = -1}), InvalidInput);
  EXPECT_THROW(separate_contacts(source, source.vertices, {.gap = 0.1, .reach = 0.05}), InvalidInput);
}

TEST(SeparateContacts, MovesNothingFarFromContacts) {
  const TriangleMesh ball = shapes::icosphere(5);
  const auto apart = [&](double distance) {
    return shapes::joined(ball, shapes::moved(ball, {Matrix3::Identity(), distance * direction}));
  };
  const TriangleMesh source = apart(4), fitted = apart(1.999);
  const ContactFit fit = separate_contacts(source, fitted.vertices, contact_options);
  EXPECT_EQ(fit.summary.left, 0u);
  for (Eigen::Index i = 0; i < ball.vertices.cols(); ++i)
    if (ball.vertices.col(i).dot(direction) < -0.5) {
      EXPECT_EQ(fit.vertices.col(i), fitted.vertices.col(i));
    }
}

}  // namespace
}  // namespace bespoke
