#include "bespoke/asset/model_distances.h"

#include <gtest/gtest.h>

#include <cmath>

#include "asset/small_asset.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/error.h"
#include "support/scratch_directory.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

const Vector3 ball_center(3, -2, 1);

std::vector<double> ball_distance(const Points& x) {
  std::vector<double> values;
  for (const auto& point : x.colwise()) values.push_back((point - ball_center).norm() - 2);
  return values;
}

TriangleMesh ball() {
  TriangleMesh mesh = shapes::icosphere(5);
  mesh.vertices = (2 * mesh.vertices).colwise() + ball_center;
  return mesh;
}

/// A hemisphere's side as winding numbers give it: its mouth is closed.
Asset with_distances(const TriangleMesh& source, const TriangleMesh& target) {
  return with_model_distances(with_preview(test::small_asset(), source), {source, ball_distance},
                              {target, ball_distance});
}

Points along_ray(const std::vector<double>& radii) {
  const Vector3 direction = Vector3(0.3, -0.5, 0.8).normalized();
  Points x(3, static_cast<Eigen::Index>(radii.size()));
  for (std::size_t i = 0; i < radii.size(); ++i)
    x.col(static_cast<Eigen::Index>(i)) = ball_center + radii[i] * direction;
  return x;
}

TEST(ModelDistances, OfASphereAreTheDistanceToIt) {
  const auto distances = model_distances(with_distances(ball(), ball()));
  ASSERT_TRUE(distances);
  const DistanceGrid& target = distances->target;
  EXPECT_NEAR(target.band(), 3 * target.voxel_size(), 1e-6);
  EXPECT_LT(target.error(), 0.02 * target.voxel_size());
  const double band = target.band();
  std::vector<double> radii;
  for (double offset = -0.9; offset < 0.9; offset += 0.01) radii.push_back(2 + offset * band);
  const std::vector<double> values = target(along_ray(radii));
  for (std::size_t i = 0; i < radii.size(); ++i)
    EXPECT_NEAR(values[i], radii[i] - 2,
                (std::abs(radii[i] - 2) < band / 3 ? 0.01 : 0.1) * target.voxel_size());
}

TEST(ModelDistances, AreEqualWhereGridsAre) {
  const Asset asset = with_distances(ball(), ball());
  const auto once = model_distances(asset), again = model_distances(asset);
  EXPECT_TRUE(once->target == again->target);
  TriangleMesh larger = ball();
  larger.vertices *= 1.01;
  EXPECT_FALSE(once->source == model_distances(with_distances(larger, ball()))->source);
}

TEST(ModelDistances, BeyondTheBandTheSideIsKnown) {
  const DistanceGrid target = model_distances(with_distances(ball(), ball()))->target;
  const std::vector<double> values = target(along_ray({0, 0.5, 1.5, 2.5, 4, 1000, 1e300}));
  for (std::size_t i = 0; i < values.size(); ++i)
    EXPECT_FLOAT_EQ(static_cast<float>(values[i]), static_cast<float>(i < 3 ? -target.band() : target.band()))
        << i;
}

TEST(ModelDistances, AreReadBackFromTheFile) {
  const test::ScratchDirectory scratch;
  const Asset asset = with_distances(ball(), ball());
  write_asset(scratch / "map.vdb", asset);
  const auto written = model_distances(asset), read = model_distances(read_asset(scratch / "map.vdb"));
  ASSERT_TRUE(read);
  const Points x = along_ray({1.7, 1.99, 2.03, 2.2});
  EXPECT_EQ(read->source(x), written->source(x));
  EXPECT_EQ(read->target(x), written->target(x));
  EXPECT_EQ(read->target.error(), written->target.error());
}

TEST(ModelDistances, OfAnOpenSourceHaveAGridOfTheirOwn) {
  TriangleMesh open = ball();
  open.faces.conservativeResize(3, open.faces.cols() - 1);
  const auto distances = model_distances(with_distances(open, ball()));
  const Points inside = along_ray({1.95});
  EXPECT_NEAR(distances->source(inside).front(), -0.05, 1e-3);
}

TEST(ModelDistances, AFileOfBeforeHasNone) {
  const test::ScratchDirectory scratch;
  write_asset(scratch / "old.vdb", test::tiny_asset());
  const Asset old = read_asset(scratch / "old.vdb");
  EXPECT_FALSE(model_distances(old));
  EXPECT_FALSE(model_distances(with_model_distances_of(old, old, old, true)));
}

TEST(ModelDistances, TurnWithAnInverse) {
  TriangleMesh small = ball();
  small.vertices = (0.5 * (small.vertices.colwise() - ball_center)).colwise() + ball_center;
  const auto small_distance = [](const Points& x) {
    std::vector<double> values = ball_distance(x);
    for (double& value : values) value += 1;
    return values;
  };
  const Asset forth = with_model_distances(with_preview(test::small_asset(), ball()), {ball(), ball_distance},
                                           {small, small_distance});
  const auto back = model_distances(with_model_distances_of(forth, forth, forth, true));
  EXPECT_NEAR(back->source(along_ray({1.02})).front(), 0.02, 1e-3);
  EXPECT_NEAR(back->target(along_ray({2.02})).front(), 0.02, 2e-2);
}

TEST(ModelDistances, RequirePreviews) {
  const TriangleMesh mesh = ball();
  EXPECT_THROW(with_model_distances(test::small_asset(), {mesh, ball_distance}, {mesh, ball_distance}),
               InvalidInput);
}

}  // namespace
}  // namespace bespoke
