#include "bespoke/page/carried_picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>
#include <vector>

#include "bespoke/error.h"
#include "support/analytic_map.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr int picture_size = 48;

const TriangleMesh model = shapes::icosphere(3);
const std::vector<TriangleMesh> products{
    shapes::moved(shapes::cube(), {Matrix3::Identity(), {0.8, 0.1, 0.3}})};

const AnalyticMap stays({});
const AnalyticMap grows({}, {Vector3(1, 2, 1).asDiagonal().toDenseMatrix(), Vector3::Zero()});

TriangleMesh stretched(TriangleMesh mesh) {
  mesh.vertices.row(1) *= 2;
  return mesh;
}

// The way there begins at the source with its products, and ends at the target.
TEST(CarriedPicture, ShowsTheWayFromSourceToTarget) {
  const TriangleMesh target = stretched(model);
  const auto picture = [&](double t) {
    return carried_picture({grows, {}, {}, t, model, target, products}, picture_size);
  };
  const std::vector<TriangleMesh> large{stretched(products[0])};
  EXPECT_EQ(picture(0), carried_picture({stays, {}, {}, 1, model, model, products}, picture_size));
  EXPECT_EQ(picture(1), carried_picture({stays, {}, {}, 1, target, target, large}, picture_size));
  EXPECT_NE(picture(0.5), picture(0));
  EXPECT_NE(picture(0.5), picture(1));
  EXPECT_THAT(picture(1), testing::StartsWith("\x89PNG"));
}

TEST(CarriedPicture, StaysBeforeTheFrontOfTheSource) {
  const RigidTransform turned{Eigen::AngleAxisd(std::numbers::pi / 2, Vector3::UnitY()).toRotationMatrix(),
                              Vector3(3, 0, 4)};
  const TriangleMesh target = shapes::moved(model, {turned.rotation, turned.translation});
  const auto shown = [&](const RigidTransform& rigid, const TriangleMesh& there) {
    return carried_picture({stays, rigid, {}, 0.5, model, there, products}, picture_size);
  };
  EXPECT_EQ(shown(turned, target), shown({}, model));
}

TEST(CarriedPicture, LeavesPointsOutAndNeedsAModel) {
  const std::vector<TriangleMesh> points{{Points::Random(3, 5), {}}};
  EXPECT_EQ(carried_picture({stays, {}, {}, 1, model, model, points}, picture_size),
            carried_picture({stays, {}, {}, 1, model, model, {}}, picture_size));
  EXPECT_THROW(carried_picture({stays, {}, {}, 1, {}, {}, {}}, picture_size), InvalidInput);
}

}  // namespace
}  // namespace bespoke
