#include "bespoke/cloud/detail/moving_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/random_points.h"

namespace bespoke {
namespace {

/// Elements of one reach, and what they say of a place.
struct Cloud {
  std::vector<SurfaceElement> elements;

  void add(const Vector3& point, const Vector3& normal, double reach = 1) {
    elements.push_back({point, normal, reach});
  }
  std::optional<SurfaceEstimate> at(const Vector3& x) const {
    Points points(3, static_cast<Eigen::Index>(elements.size()));
    for (std::size_t i = 0; i < elements.size(); ++i)
      points.col(static_cast<Eigen::Index>(i)) = elements[i].point;
    const MovingSurface surface(elements, points);
    std::vector<int> near;
    surface.gather(x, 0, near);
    return surface.estimate(x, near);
  }
};

Vector3 flat(const Vector3& x) { return {x.x(), x.y(), 0}; }

TEST(MovingSurface, OfAPlaneIsThePlane) {
  Cloud cloud;
  const Points places = test::random_points(300, 1);
  for (const auto& place : places.colwise()) cloud.add(flat(place), Vector3::UnitZ());
  for (const double height : {-0.4, 0., 0.3}) {
    const auto found = cloud.at({0.2, -0.1, height});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->distance, height, 1e-15);
    EXPECT_NEAR((found->normal - Vector3::UnitZ()).norm(), 0, 1e-15);
  }
}

TEST(MovingSurface, MeetsASphereWhereEitherClassicFormIsOffByItsCurvature) {
  // Rings about the pole, so that the mean normal there is exact.
  Cloud cloud;
  double planes = 0, points = 0, weights = 0;
  const Vector3 pole = Vector3::UnitZ();
  for (int ring = 1; ring <= 4; ++ring)
    for (int k = 0; k < 12; ++k) {
      const double polar = 0.1 * ring, turn = k * std::numbers::pi / 6;
      const Vector3 p(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar));
      cloud.add(p, p, 0.6);
      const double w = std::pow(1 - (pole - p).squaredNorm() / 0.36, 4) * p.z();
      weights += w;
      planes += w * p.dot(pole - p);
      points += w * pole.dot(pole - p);
    }
  const auto found = cloud.at(pole);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->distance, 0, 1e-15);
  EXPECT_LT(planes / weights, -0.01);
  EXPECT_GT(points / weights, 0.01);
}

TEST(MovingSurface, KeepsSheetsThatFaceAwayApart) {
  Cloud cloud;
  const Points places = test::random_points(600, 2);
  const double gap = 0.2;
  for (const auto& place : places.colwise()) {
    cloud.add(flat(place), -Vector3::UnitZ());
    cloud.add(flat(place) + gap * Vector3::UnitZ(), Vector3::UnitZ());
  }
  EXPECT_NEAR(cloud.at({0, 0, 0})->distance, 0, 1e-15);
  EXPECT_NEAR(cloud.at({0, 0, gap})->distance, 0, 1e-15);
  EXPECT_LT(cloud.at({0, 0, gap / 2})->distance, -0.09) << "inside, however near both";
}

TEST(MovingSurface, SaysHowFarAsideThePointsLie) {
  Cloud cloud;
  for (int i = 0; i < 100; ++i)
    for (int k = 0; k < 200; ++k) cloud.add({0.01 * (i - 100), 0.01 * (k - 100), 0}, Vector3::UnitZ(), 0.5);
  EXPECT_NEAR(cloud.at({-0.5, 0, 0})->off_centre, 0, 1e-2);
  // On the rim of a half-plane: ∫∫ r² cos a w / ∫∫ r w = (2/π) ∫ r² w / ∫ r w with w = (1 − r²)⁴, r ≤ 1.
  const double r2 = 1. / 3 - 4. / 5 + 6. / 7 - 4. / 9 + 1. / 11, r1 = 1. / 10;
  EXPECT_NEAR(cloud.at({0, 0, 0})->off_centre, 2 / std::numbers::pi * r2 / r1, 1e-2);
}

TEST(MovingSurface, SaysNothingBeyondItsReach) {
  Cloud cloud;
  cloud.add(Vector3::Zero(), Vector3::UnitZ());
  EXPECT_TRUE(cloud.at({0, 0, 0.99}));
  EXPECT_FALSE(cloud.at({0, 0, 1.01}));
}

}  // namespace
}  // namespace bespoke
