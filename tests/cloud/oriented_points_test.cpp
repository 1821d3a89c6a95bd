#include "bespoke/cloud/oriented_points.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "bespoke/mesh/triangle_mesh.h"
#include "cloud/sampled_clouds.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

std::string complaint(const OrientedPoints& cloud) {
  return test::error_message<InvalidInput>([&] { require_valid(cloud, "target a.ply"); });
}

TEST(OrientedPoints, OfEnoughPointsWithNormalsOfAnyLengthAreValid) {
  OrientedPoints cloud = test::sphere_cloud(min_cloud_points);
  EXPECT_EQ(complaint(cloud), "accepted");
  cloud.normals *= 1e-200;
  EXPECT_EQ(complaint(cloud), "accepted");
}

TEST(OrientedPoints, AreRefusedWithTheValueAtFault) {
  EXPECT_THAT(complaint(test::sphere_cloud(99)),
              HasSubstr("target a.ply: a point cloud of 99 points shows no surface; it needs at least 100"));
  OrientedPoints cloud = test::sphere_cloud(200);
  cloud.normals.col(17).setZero();
  cloud.normals(1, 30) = std::numeric_limits<double>::quiet_NaN();
  cloud.normals(2, 31) = std::numeric_limits<double>::infinity();
  EXPECT_THAT(complaint(cloud),
              HasSubstr("3 of 200 normals are zero or not finite, the first that of point 17"));
  cloud = test::sphere_cloud(200);
  cloud.points(0, 5) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(complaint(cloud), HasSubstr("point 5 has a coordinate that is not finite"));
  cloud.points.setOnes();
  EXPECT_THAT(complaint(cloud), HasSubstr("all points lie at one place"));
  cloud.normals = Points(3, 199);
  EXPECT_THAT(complaint(cloud), HasSubstr("200 points, but 199 normals"));
}

TEST(OrientedPoints, HashNamesPointsAndNormalsAsFloatsInTheirOrder) {
  const OrientedPoints cloud = test::sphere_cloud(200);
  const std::string hash = content_hash(cloud);
  OrientedPoints other = cloud;
  other.points *= 1 + 1e-12;
  EXPECT_EQ(content_hash(other), hash);
  other.normals.col(3) = -other.normals.col(3);
  EXPECT_NE(content_hash(other), hash);
  other = cloud;
  other.points(0, 3) += 1e-3;
  EXPECT_NE(content_hash(other), hash);
  EXPECT_NE(content_hash(test::shuffled(cloud, 1)), hash);
  EXPECT_NE(content_hash(TriangleMesh{cloud.points, Faces(3, 0)}), hash);
}

}  // namespace
}  // namespace bespoke
