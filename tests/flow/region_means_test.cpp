#include "bespoke/flow/detail/region_means.h"

#include <gtest/gtest.h>

#include "bespoke/flow/detail/face_gradients.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(RegionMeans, OfOneValueAreThatValueEverywhere) {
  const TriangleMesh mesh = shapes::icosphere(3);
  const Eigen::VectorXd areas = face_gradients(mesh, mesh.vertices).areas;
  int regions = 0;
  for_each_region(
      mesh, areas, [](Eigen::Index) -> Matrix3 { return 2 * Matrix3::Identity(); },
      [&](const Matrix3& mean) {
        EXPECT_LT((mean - 2 * Matrix3::Identity()).norm(), 1e-12);
        ++regions;
      });
  EXPECT_GT(regions, 10);
}

TEST(RegionMeans, WeighFacesByArea) {
  // Both faces lie within one region of the long thin rest.
  TriangleMesh mesh{Points(3, 6), Faces(3, 2)};
  mesh.vertices << 0, 1, 0, 0, 1, 100, 0, 0, 1, 0, 0, 0, 0, 0, 0, 3, 3, 0;
  mesh.faces << 0, 3, 1, 4, 2, 0;
  const Eigen::VectorXd areas = face_gradients(mesh, mesh.vertices).areas;
  for_each_region(
      mesh, areas,
      [&](Eigen::Index face) -> Matrix3 { return (face == 0 ? 1.0 : 4.0) * Matrix3::Identity(); },
      [&](const Matrix3& mean) {
        EXPECT_NEAR(mean(0, 0), (areas[0] + 4 * areas[1]) / (areas[0] + areas[1]), 1e-12);
      });
}

TEST(RegionMeans, OfFacesWithoutAreaAreNone) {
  TriangleMesh mesh = shapes::triangle();
  for_each_region(
      mesh, Eigen::VectorXd::Zero(1), [](Eigen::Index) -> Matrix3 { return Matrix3::Identity(); },
      [](const Matrix3&) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace bespoke
