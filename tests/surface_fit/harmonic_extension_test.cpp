#include "bespoke/surface_fit/matching/harmonic_extension.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

/// The vertices of a grid that are not on its boundary.
std::vector<int> inner_vertices(const TriangleMesh& mesh) {
  const std::vector<char> on_boundary = boundary_vertices(mesh);
  std::vector<int> inner;
  for (std::size_t i = 0; i < on_boundary.size(); ++i)
    if (!on_boundary[i]) inner.push_back(static_cast<int>(i));
  return inner;
}

TEST(HarmonicExtension, ReproducesAffineDisplacementsOfAGrid) {
  const TriangleMesh grid = shapes::square_grid(8);
  const Matrix3 linear{{0.1, 0.2, 0}, {-0.3, 0.1, 0}, {0.5, 0.4, 0}};
  const Points displacements = (linear * grid.vertices).colwise() + Vector3(1, 2, 3);
  Points given = displacements;
  const std::vector<int> inner = inner_vertices(grid);
  ASSERT_FALSE(inner.empty());
  given(Eigen::all, inner).setConstant(7);
  const Points found = extend_harmonically(grid.vertices, vertex_adjacency(grid), inner, given);
  EXPECT_TRUE(found.isApprox(displacements, 1e-7));
}

// The maximum principle: nothing inside goes farther than what surrounds it.
TEST(HarmonicExtension, StaysWithinWhatSurroundsIt) {
  const TriangleMesh grid = shapes::square_grid(6);
  Points given = Points::Zero(3, grid.vertices.cols());
  given.row(2) = grid.vertices.row(0).array().sin();
  const std::vector<int> inner = inner_vertices(grid);
  const Points found = extend_harmonically(grid.vertices, vertex_adjacency(grid), inner, given);
  EXPECT_LE(found.row(2).maxCoeff(), given.row(2).maxCoeff() + 1e-9);
  EXPECT_GE(found.row(2).minCoeff(), given.row(2).minCoeff() - 1e-9);
}

TEST(HarmonicExtension, MovesAComponentThatIsWhollyFreeAsAWhole) {
  const TriangleMesh grid = shapes::square_grid(3);
  std::vector<int> all(static_cast<std::size_t>(grid.vertices.cols()));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  Points given = Points::Constant(3, grid.vertices.cols(), 2);
  given.row(2) = grid.vertices.row(0);  // symmetric about 1/2, as the weights are
  const Points found = extend_harmonically(grid.vertices, vertex_adjacency(grid), all, given);
  EXPECT_LT((found.colwise() - Vector3(2, 2, 0.5)).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace bespoke
