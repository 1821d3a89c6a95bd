#include "bespoke/cloud/point_cloud_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/thread_arena.h"
#include "cloud/sampled_clouds.h"
#include "support/error_message.h"

namespace bespoke {
namespace {

using ::testing::HasSubstr;

PointCloudSurface surface_of(const OrientedPoints& cloud) {
  return point_cloud_surface(cloud, "target a.ply");
}

std::string meshing_complaint(const OrientedPoints& cloud) {
  return test::error_message<InvalidInput>([&] { surface_of(cloud); });
}

/// The h of the stated bound.
double reach(const PointCloudSummary& summary) { return summary.spacing * std::sqrt(20 / std::numbers::pi); }

double worst_on_sphere(const TriangleMesh& mesh) {
  return (mesh.vertices.colwise().norm().array() - 1).abs().maxCoeff();
}

double worst_on_torus(const TriangleMesh& mesh) {
  double worst = 0;
  for (const auto& v : mesh.vertices.colwise()) worst = std::max(worst, test::distance_from_torus(v));
  return worst;
}

TEST(PointCloudSurface, LiesWithinItsBoundOfASphere) {
  const PointCloudSurface made = surface_of(test::sphere_cloud(4000));
  EXPECT_LE(worst_on_sphere(made.mesh), 0.15 * std::pow(reach(made.summary), 2));
  EXPECT_THAT(to_string(inspect_mesh(made.mesh)), HasSubstr("1 component, closed"));
  const Points normals = vertex_normals(made.mesh);
  EXPECT_GT(normals.cwiseProduct(made.mesh.vertices).colwise().sum().minCoeff(), 0.9);
  EXPECT_NEAR(made.summary.spacing, std::sqrt(4 * std::numbers::pi / 4000), 0.1 * made.summary.spacing);
}

TEST(PointCloudSurface, LiesWithinItsBoundOfATorusAndFallsWithTheSquareOfTheSpacing) {
  const PointCloudSurface coarse = surface_of(test::torus_cloud(625)),
                          fine = surface_of(test::torus_cloud(2500));
  const double curvature = 1 / 0.4;
  EXPECT_LE(worst_on_torus(coarse.mesh), 0.15 * curvature * std::pow(reach(coarse.summary), 2));
  EXPECT_LE(worst_on_torus(fine.mesh), worst_on_torus(coarse.mesh) / 3);
  EXPECT_EQ(inspect_mesh(fine.mesh).boundary_edges, 0u);
  EXPECT_EQ(inspect_mesh(fine.mesh).components, 1u);
}

TEST(PointCloudSurface, HalvesNoiseAtLeast) {
  const double sigma = 0.02;
  const PointCloudSurface made = surface_of(test::noisy(test::sphere_cloud(6000), sigma, 0.1, 3));
  const Eigen::ArrayXd off = made.mesh.vertices.colwise().norm().array().transpose() - 1;
  EXPECT_LE(std::sqrt(off.square().mean()), sigma / 2);
  EXPECT_EQ(inspect_mesh(made.mesh).boundary_edges, 0u);
}

TEST(PointCloudSurface, OfAHemisphereStaysOpen) {
  const OrientedPoints cloud =
      test::filtered(test::sphere_cloud(8000), [](const auto& p) { return p.z() > 0; });
  const PointCloudSurface made = surface_of(cloud);
  EXPECT_EQ(inspect_mesh(made.mesh).components, 1u);
  const double spacing = made.summary.spacing;
  EXPECT_GT(made.mesh.vertices.row(2).minCoeff(), -2 * spacing);
  const std::vector<char> boundary = boundary_vertices(made.mesh);
  EXPECT_GT(std::count(boundary.begin(), boundary.end(), 1), 50);
  for (Eigen::Index i = 0; i < made.mesh.vertices.cols(); ++i)
    if (boundary[static_cast<std::size_t>(i)]) {
      EXPECT_LT(made.mesh.vertices(2, i), spacing);
    }
  EXPECT_LE(worst_on_sphere(made.mesh), 0.3 * std::pow(reach(made.summary), 2));
}

TEST(PointCloudSurface, KeepsHolesOfSixSpacings) {
  const OrientedPoints whole = test::sphere_cloud(8000);
  const double radius = 3 * std::sqrt(4 * std::numbers::pi / 8000);
  const OrientedPoints cloud =
      test::filtered(whole, [&](const auto& p) { return (p - Vector3::UnitX()).norm() > radius; });
  const std::vector<char> boundary = boundary_vertices(surface_of(cloud).mesh);
  EXPECT_GT(std::count(boundary.begin(), boundary.end(), 1), 4);
  EXPECT_EQ(inspect_mesh(surface_of(whole).mesh).boundary_edges, 0u);
}

TEST(PointCloudSurface, KeepsTwoSidesOfAThinPlateApart) {
  OrientedPoints cloud{Points(3, 5000), Points(3, 5000)};
  const Points places = test::random_points(5000, 8);
  const double thickness = 0.1;  // about 2.5 spacings, as far as a point's weight reaches
  for (Eigen::Index i = 0; i < 5000; ++i) {
    const double side = i % 2 == 0 ? 1 : -1;
    cloud.points.col(i) = Vector3(places(0, i), places(1, i), side * thickness / 2);
    cloud.normals.col(i) = Vector3(0, 0, side);
  }
  const PointCloudSurface made = surface_of(cloud);
  EXPECT_EQ(inspect_mesh(made.mesh).components, 2u);
  for (const auto& v : made.mesh.vertices.colwise()) EXPECT_NEAR(std::abs(v.z()), thickness / 2, 1e-4);
}

TEST(PointCloudSurface, DependsNeitherOnTheOrderOfThePointsNorOnThreads) {
  const OrientedPoints cloud = test::noisy(test::torus_cloud(3000), 0.01, 0.1, 4);
  const TriangleMesh mesh = surface_of(cloud).mesh, other = surface_of(test::shuffled(cloud, 2)).mesh;
  EXPECT_TRUE(mesh.vertices == other.vertices);
  EXPECT_TRUE(mesh.faces == other.faces);
  run_on_threads(1, [&] { EXPECT_EQ(content_hash(surface_of(cloud).mesh), content_hash(mesh)); });
}

TEST(PointCloudSurface, CountsWhatIsUnusual) {
  const OrientedPoints sphere = test::sphere_cloud(3000);
  OrientedPoints cloud{Points(3, 3006), Points(3, 3006)};
  cloud.points << sphere.points, sphere.points.leftCols(5), Vector3(4, 4, 4);
  cloud.normals << sphere.normals, sphere.normals.leftCols(5), Vector3(1, 0, 0);
  cloud.normals.col(700) *= -1;
  const PointCloudSurface made = surface_of(cloud);
  EXPECT_EQ(made.summary.points, 3006u);
  EXPECT_EQ(made.summary.duplicates, 5u);
  EXPECT_EQ(made.summary.isolated, 1u);
  EXPECT_EQ(made.summary.contradicting, 1u);
  EXPECT_EQ(made.summary.distances.count, 3000u);
  EXPECT_EQ(inspect_mesh(made.mesh).boundary_edges, 0u);
  EXPECT_LE(worst_on_sphere(made.mesh), 0.15 * std::pow(reach(made.summary), 2));
  EXPECT_THAT(to_string(made.summary),
              HasSubstr("5 of them twice, 1 isolated left out, 1 facing against its neighbours"));
}

TEST(PointCloudSurface, RefusesNormalsWithoutAnOrder) {
  OrientedPoints cloud = test::sphere_cloud(2000);
  std::mt19937 coin(6);
  for (auto normal : cloud.normals.colwise())
    if (coin() % 2 == 0) normal = -normal;
  EXPECT_THAT(meshing_complaint(cloud),
              HasSubstr("of the normals face against their neighbours; orient them"));
}

TEST(PointCloudSurface, RefusesCloudsThatAreNotValid) {
  EXPECT_THAT(meshing_complaint(test::sphere_cloud(20)),
              HasSubstr("target a.ply: a point cloud of 20 points"));
  OrientedPoints heap = test::sphere_cloud(200);
  for (auto point : heap.points.colwise()) point = point.cwiseSign();
  EXPECT_THAT(meshing_complaint(heap), HasSubstr("its points lie at only"));
}

}  // namespace
}  // namespace bespoke
