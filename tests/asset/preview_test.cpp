#include "bespoke/asset/grids/preview.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "asset/small_asset.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"

namespace bespoke {
namespace {

void for_each_node(const StoredGrid& grid,
                   const std::function<void(const Vector3& x, std::size_t node)>& body) {
  for (std::size_t leaf = 0; leaf < grid.leaves.size(); ++leaf)
    for (int n = 0; n < leaf_nodes; ++n) {
      const Vector3 local(n / 64, n / 8 % 8, n % 8);
      const LeafCoordinates& c = grid.leaves[leaf];
      body(grid.origin + grid.voxel_size * (8 * Vector3(c[0], c[1], c[2]) + local),
           leaf * leaf_nodes + static_cast<std::size_t>(n));
    }
}

double metadata_number(const StoredGrid& grid, const std::string& key) {
  return std::get<double>(grid.metadata.at(key));
}

TEST(DisplacementPreview, IsThatOfTheMapAtItsNodes) {
  const Asset asset = with_preview(test::small_asset(), test::sphere({0, 0, 0}, 1, 2));
  const BakedMap baked(asset.steps.front().affine, asset.steps.front().pyramid);
  const StoredGrid& grid = asset.preview->grids()[0];
  for_each_node(grid, [&](const Vector3& x, std::size_t node) {
    const Vector3 moved = asset.target_from_source * Vector3(baked(Points(x)));
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_NEAR(grid.values[3 * node + static_cast<std::size_t>(axis)], moved[axis] - x[axis], 1e-6);
  });
  EXPECT_GT(metadata_number(grid, "bespoke:error_max"), 1e-6);
}

TEST(DisplacementPreview, OfAnAffineMapHasNoErrorButRounding) {
  Asset asset = test::small_asset();
  asset.steps.front().pyramid.levels.clear();
  asset = with_preview(asset, test::sphere({0, 0, 0}, 1, 2));
  EXPECT_LT(metadata_number(asset.preview->grids()[0], "bespoke:error_max"), 1e-6);
}

TEST(DisplacementPreview, CoversTheSourceAndItsBand) {
  const Asset asset = with_preview(test::small_asset(), test::sphere({0, 0, 0}, 1, 2));
  Box covered;
  for_each_node(asset.preview->grids()[0], [&](const Vector3& x, std::size_t) { covered.extend(x); });
  EXPECT_TRUE(covered.contains(Box(Vector3::Constant(-1.4), Vector3::Constant(1.4))));
}

TEST(JacobianPreview, OfAnAffineMapIsItsDeterminant) {
  Asset asset = test::small_asset();
  asset.steps.front().pyramid.levels.clear();
  asset = with_preview(asset, test::sphere({0, 0, 0}, 1, 2));
  for (const float value : asset.preview->grids()[2].values)
    ASSERT_NEAR(value, asset.steps.front().affine.linear.determinant() - 1, 1e-6);
}

TEST(JacobianPreview, BoundsTheDeterminantFromBelow) {
  const Asset asset = with_preview(test::small_asset(), test::sphere({0, 0, 0}, 1, 2));
  const BakedMap baked(asset.steps.front().affine, asset.steps.front().pyramid);
  const StoredGrid& grid = asset.preview->grids()[2];
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-0.999, 0.999);
  double least = 1;
  for_each_node(grid, [&](const Vector3& node, std::size_t n) {
    const Vector3 x = node + grid.voxel_size * Vector3(within(random), within(random), within(random));
    const double determinant =
        (asset.steps.front().affine.linear + Matrix3(baked.displacement_gradient(Points(x)))).determinant();
    least = std::min(least, determinant);
    ASSERT_LE(grid.values[n] + 1.0, determinant + 1e-9) << x.transpose();
  });
  // The bound is that of a few cells, not something far below.
  EXPECT_GT(*std::min_element(grid.values.begin(), grid.values.end()) + 1, least - 0.2);
}

TEST(SourceDistance, OfASphereIsTheDistanceToIt) {
  const TriangleMesh sphere = test::sphere({3, -2, 1}, 2, 5);
  const StoredGrid grid = source_distance_preview(sphere);
  EXPECT_EQ(grid.grid_class, GridClass::level_set);
  std::size_t inside = 0;
  for_each_node(grid, [&](const Vector3& x, std::size_t node) {
    if (!(grid.active[node / leaf_nodes][node % leaf_nodes / 64] >> node % 64 & 1)) return;
    const double distance = (x - Vector3(3, -2, 1)).norm() - 2;
    // Far from the surface OpenVDB looks at the triangles of neighbouring voxels only.
    const bool near = std::abs(distance) < 1.5 * grid.voxel_size;
    ASSERT_NEAR(grid.values[node], distance, (near ? 0.05 : 0.5) * grid.voxel_size);
    inside += distance < 0;
  });
  EXPECT_GT(inside, 1000u);
}

TEST(SourceDistance, OfAnOpenMeshIsAShell) {
  TriangleMesh triangle;
  triangle.vertices.resize(3, 3);
  triangle.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  triangle.faces.resize(3, 1);
  triangle.faces << 0, 1, 2;
  const StoredGrid grid = source_distance_preview(triangle);
  EXPECT_EQ(grid.grid_class, GridClass::level_set);
  EXPECT_NE(std::get<std::string>(grid.metadata.at("bespoke:meaning")).find("open"), std::string::npos);
  for_each_node(grid, [&](const Vector3& x, std::size_t node) {
    if (!(grid.active[node / leaf_nodes][node % leaf_nodes / 64] >> node % 64 & 1)) return;
    if (x.x() < 0 || x.y() < 0 || x.x() + x.y() > 1) return;
    ASSERT_NEAR(grid.values[node], std::min(std::abs(x.z()) - grid.voxel_size, 3 * grid.voxel_size), 1e-5);
  });
}

TEST(SourceDistance, OfAMeshWithTwoPiecesHoldsBoth) {
  TriangleMesh pair = test::sphere({0, 0, 0}, 1, 2);
  const TriangleMesh other = test::sphere({5, 0, 0}, 1, 2);
  const Eigen::Index vertices = pair.vertices.cols(), faces = pair.faces.cols();
  pair.vertices.conservativeResize(3, 2 * vertices);
  pair.vertices.rightCols(vertices) = other.vertices;
  pair.faces.conservativeResize(3, 2 * faces);
  pair.faces.rightCols(faces) = other.faces.array() + static_cast<int>(vertices);
  Box covered;
  const StoredGrid grid = source_distance_preview(pair);
  for_each_node(grid, [&](const Vector3& x, std::size_t node) {
    if (grid.values[node] < 0) covered.extend(x);
  });
  EXPECT_LT(covered.min().x(), -0.9);
  EXPECT_GT(covered.max().x(), 5.9);
}

TEST(WithPreview, RefusesAnEmptySource) {
  EXPECT_THROW(with_preview(test::small_asset(), TriangleMesh{}), InvalidInput);
}

}  // namespace
}  // namespace bespoke
