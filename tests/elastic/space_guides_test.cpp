#include "bespoke/elastic/space_guides.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "bespoke/elastic/multiscale.h"
#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "support/bent_tube.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

Points bent_by(const Points& x, double degrees) {
  Points result = x;
  for (auto point : result.colwise()) point = shapes::bent(Vector3(point), degrees);
  return result;
}

TEST(SpaceGuides, GoWhereASimilarityTakesThem) {
  const TriangleMesh round = shapes::icosphere(3);
  const Matrix3 turned = test::random_rotation(5);
  const auto similarity = [&](const Points& x) -> Points {
    return (1.7 * turned * x).colwise() + Vector3(1, 2, 3);
  };
  const SpaceGuides guides = space_guides(round, similarity(round.vertices), 0.5);
  EXPECT_EQ(guides.offset, 0.2);
  ASSERT_GT(guides.sources.cols(), 50);
  EXPECT_LT((guides.targets - similarity(guides.sources)).cwiseAbs().maxCoeff(), 1e-12);
  const ClosestPointTree surface(round);
  for (const auto& place : guides.sources.colwise()) {
    EXPECT_GT(place.norm(), 1.1);
    EXPECT_GE(std::sqrt(surface.closest(place)->squared_distance), 0.18);
  }
}

TEST(SpaceGuides, TurnWithASurfaceWhoseEdgesAreLongerThanTheirOffset) {
  const TriangleMesh coarse = shapes::icosphere(2);
  const Matrix3 turned = test::random_rotation(5);
  const SpaceGuides guides = space_guides(coarse, turned * coarse.vertices, 0.25);
  EXPECT_EQ(guides.sources.cols(), coarse.vertices.cols());
  EXPECT_LT((guides.targets - turned * guides.sources).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SpaceGuides, TurnWithTheirLimb) {
  const TriangleMesh tube = shapes::tube();
  const Points fitted = bent_by(tube.vertices, 30);
  const SpaceGuides guides = space_guides(tube, fitted, 0.5);
  // The elbow's own faces grow, which makes the whole a little larger.
  const double scale = std::sqrt(vertex_areas({fitted, tube.faces}).sum() / vertex_areas(tube).sum());
  ASSERT_NEAR(scale, 1, 0.01);
  const double reach = 0.21;  // from where nothing beyond the elbow is within the offset
  int beyond = 0;
  for (Eigen::Index i = 0; i < guides.sources.cols(); ++i) {
    const Vector3 x = guides.sources.col(i);
    if (std::abs(x[0] - shapes::elbow) < reach) continue;
    beyond += x[0] > shapes::elbow;
    EXPECT_NEAR((guides.targets.col(i) - shapes::bent(x, 30)).norm(), std::abs(scale - 1) * guides.offset,
                1e-9);
  }
  EXPECT_GT(beyond, 50);
}

TEST(SpaceGuides, AreNoneBetweenPartsThatAreNear) {
  const TriangleMesh square = shapes::square_grid(20);
  AffineMap flipped{Vector3(1, -1, -1).asDiagonal(), Vector3(0, 1, 0)};
  const auto plates = [&](double apart) {
    flipped.offset.z() = apart;
    return shapes::joined(square, shapes::moved(square, flipped));
  };
  const TriangleMesh far = plates(0.5), near = plates(0.15);  // facing each other
  const auto count = [](const TriangleMesh& source, const TriangleMesh& fitted) {
    return space_guides(source, fitted.vertices, 0.25).sources.cols();
  };
  EXPECT_GT(count(far, far), 100);
  EXPECT_EQ(count(near, near), 0);
  EXPECT_EQ(count(far, near), 0);
}

TEST(SpaceGuides, NeitherCrowdNorPartMoreThanTwofold) {
  // Guides are at .2: the gap of .8 between them shrinks to .06, or grows from it.
  const auto apart_by = [](double gap) {
    const AffineMap aside{Matrix3::Identity(), Vector3(2 + gap, 0, 0)};
    return shapes::joined(shapes::icosphere(3), shapes::moved(shapes::icosphere(3), aside));
  };
  const TriangleMesh far = apart_by(1.2), near = apart_by(0.46);
  for (const auto& [source, fitted] : {std::pair(far, near.vertices), std::pair(near, far.vertices)}) {
    const SpaceGuides guides = space_guides(source, fitted, 0.5);
    EXPECT_GT(guides.sources.cols(), 100);
    for (Eigen::Index i = 0; i < guides.sources.cols(); ++i)
      for (Eigen::Index j = 0; j < i; ++j) {
        const double here = (guides.sources.col(i) - guides.sources.col(j)).norm();
        const double there = (guides.targets.col(i) - guides.targets.col(j)).norm();
        if (std::min(here, there) > guides.offset) continue;
        EXPECT_LE(there, 2 * here);
        EXPECT_LE(here, 2 * there);
      }
  }
}

TEST(SpaceGuides, RefuseWhatTheyCannotFollow) {
  const TriangleMesh square = shapes::square_grid(2);
  EXPECT_THROW(space_guides(square, square.vertices.leftCols(2), 0.5), InvalidInput);
  EXPECT_THROW(space_guides(square, square.vertices, 0), InvalidInput);
  EXPECT_THROW(space_guides(square, square.vertices, std::nan("")), InvalidInput);
  Points broken = square.vertices;
  broken(0, 0) = std::numeric_limits<double>::infinity();
  EXPECT_THROW(space_guides(square, broken, 0.5), InvalidInput);
}

/// How far places at a distance around the forearm lie from where it takes them as a rigid body.
double lag(const MultiscaleMap& map, double distance, double degrees) {
  double largest = 0;
  for (double along = 2.8; along < 3.5; along += 0.1)
    for (double angle = 0; angle < 6; angle += 0.5) {
      const double radius = 0.2 + distance;
      const Vector3 x(along, radius * std::cos(angle), radius * std::sin(angle));
      const Vector3 image = map(Points(x));
      largest = std::max(largest, (image - shapes::bent(x, degrees)).norm());
    }
  return largest;
}

TEST(SpaceGuides, LetNoSleeveLagBehindItsArm) {
  const TriangleMesh tube = shapes::tube();
  const double degrees = 20, radius = 0.5;
  const Points fitted = bent_by(tube.vertices, degrees);
  for (const bool composed : {false, true}) {
    MultiscaleOptions options{radius, 1e-3, composed};
    const MultiscaleFit plain = fit_multiscale(tube.vertices, fitted, options);
    options.guides = space_guides(tube, fitted, radius);
    const MultiscaleFit guided = fit_multiscale(tube.vertices, fitted, options);
    EXPECT_LT(lag(*guided.map, 0.15, degrees), 0.5 * lag(*plain.map, 0.15, degrees)) << composed;
    EXPECT_EQ(guided.summary.residuals.count, plain.summary.residuals.count);
    EXPECT_LE(guided.summary.residuals.p95, 1e-3);
    EXPECT_TRUE(guided.map->affine().linear.isApprox(plain.map->affine().linear, 1e-15));
  }
}

TEST(SpaceGuides, AreRefusedByAMapWhenTheyDoNotBelongTogether) {
  const TriangleMesh tube = shapes::tube();
  const auto fit = [&](const SpaceGuides& guides) {
    MultiscaleOptions options{0.5, 1e-3};
    options.guides = guides;
    fit_multiscale(tube.vertices, tube.vertices, options);
  };
  const Points two = Points::Ones(3, 2);
  EXPECT_NO_THROW(fit({two, two, 0.2}));
  EXPECT_NO_THROW(fit({}));
  EXPECT_THROW(fit({two, two.leftCols(1), 0.2}), InvalidInput);
  EXPECT_THROW(fit({Points(3, 0), two, 0.2}), InvalidInput);
  EXPECT_THROW(fit({two, two, 0}), InvalidInput);
  EXPECT_THROW(fit({two, two * std::nan(""), 0.2}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
