#include "bespoke/bake/error_points.h"

#include <gtest/gtest.h>

#include "bespoke/lattice/leaf.h"

namespace bespoke {
namespace {

/// Two triangles at height `z` that cover [0, size]².
TriangleMesh square(double size, double z) {
  TriangleMesh mesh{Points(3, 4), Faces(3, 2)};
  mesh.vertices << 0, size, size, 0, 0, 0, size, size, z, z, z, z;
  mesh.faces << 0, 0, 1, 2, 2, 3;
  return mesh;
}

/// One leaf of level 0 at the leaf (1, 1, 0), and one of level 1 inside it.
Pyramid two_leaves() {
  Pyramid pyramid;
  pyramid.levels.push_back({0.1, {{1, 1, 0}}, {}});
  pyramid.levels.push_back({0.05, {{2, 2, 0}}, {}});
  return pyramid;
}

TEST(FinestCellsOn, AreThoseThatASurfacePassesThrough) {
  // The square ends where the leaf does; its plane passes through the first cells of both levels.
  const std::vector<FinestCell> cells = finest_cells_on(two_leaves(), square(1.5999, 0.01));
  int coarse = 0, fine = 0;
  for (const FinestCell& cell : cells) {
    EXPECT_EQ(cell.node[2], 0);
    ++(cell.level == 0 ? coarse : fine);
  }
  EXPECT_EQ(coarse, 8 * 8 - 4 * 4);
  EXPECT_EQ(fine, 8 * 8);
}

TEST(FinestCellsOn, AreNoneOutsideAllLeaves) {
  for (const FinestCell& cell : finest_cells_on(two_leaves(), square(100, 0.01)))
    EXPECT_EQ(leaf_of(cell.node), cell.level == 0 ? (LeafCoordinates{1, 1, 0}) : (LeafCoordinates{2, 2, 0}));
  EXPECT_TRUE(finest_cells_on(two_leaves(), square(100, 5)).empty());
}

}  // namespace
}  // namespace bespoke
