#include "bespoke/mesh/surface_paths.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "support/shapes.h"

namespace bespoke {
namespace {

using testing::ElementsAre;
using testing::Pair;

constexpr int squares = 20;  // along each side of the grid
constexpr double infinity = std::numeric_limits<double>::infinity();

int grid_vertex(const TriangleMesh& grid, double x, double y) {
  Eigen::Index nearest = 0;
  (grid.vertices.colwise() - Vector3(x, y, 0)).colwise().squaredNorm().minCoeff(&nearest);
  return static_cast<int>(nearest);
}

Eigen::VectorXd lengths_from(const SurfaceGraph& graph, int vertex) {
  const PathStart start{vertex};
  return path_lengths(graph, {&start, 1});
}

/// What lies beyond x = 1/2 turned about that line.
TriangleMesh folded(TriangleMesh mesh, double angle) {
  for (auto&& x : mesh.vertices.colwise()) {
    const double beyond = x[0] - 0.5;
    if (beyond > 0) x = Vector3(0.5 + beyond * std::cos(angle), x[1], beyond * std::sin(angle));
  }
  return mesh;
}

TEST(EdgeGraph, GoesRoundCornersThatNoEdgeCuts) {
  const TriangleMesh square = shapes::square_grid(1);
  const SurfaceGraph graph = edge_graph(square);
  std::vector<double> diagonals;
  for (const auto& [x, y] : {std::pair(0.0, 1.0), std::pair(0.0, 0.0)})
    diagonals.push_back(lengths_from(graph, grid_vertex(square, x, y))[grid_vertex(square, 1 - x, 1 - y)]);
  EXPECT_THAT(diagonals,
              testing::UnorderedElementsAre(testing::DoubleEq(2), testing::DoubleEq(std::sqrt(2))));
}

TEST(EdgeAndCrossingGraph, CutsBothDiagonalsOfASquare) {
  const TriangleMesh square = shapes::square_grid(1);
  const SurfaceGraph graph = edge_and_crossing_graph(square);
  for (const double y : {0.0, 1.0})
    EXPECT_DOUBLE_EQ(lengths_from(graph, grid_vertex(square, 0, y))[grid_vertex(square, 1, 1 - y)],
                     std::sqrt(2));
}

/// Eight directions leave at most a path of two that are 45 degrees apart.
TEST(EdgeAndCrossingGraph, IsLongerThanTheStraightLineByATwelfthAtMost) {
  const TriangleMesh grid = shapes::square_grid(squares);
  const int start = grid_vertex(grid, 0.3, 0.45);
  const Eigen::VectorXd lengths = lengths_from(edge_and_crossing_graph(grid), start);
  const double most = 1 / std::cos(std::numbers::pi / 8);
  for (Eigen::Index i = 0; i < lengths.size(); ++i) {
    const double straight = (grid.vertices.col(i) - grid.vertices.col(start)).norm();
    EXPECT_GE(lengths[i], straight * (1 - 1e-12));
    EXPECT_LE(lengths[i], straight * most * (1 + 1e-12));
  }
}

TEST(EdgeAndCrossingGraph, DoesNotSeeThatASheetIsFolded) {
  const TriangleMesh grid = shapes::square_grid(squares);
  const int start = grid_vertex(grid, 0.2, 0.4);
  const Eigen::VectorXd flat = lengths_from(edge_and_crossing_graph(grid), start);
  const Eigen::VectorXd bent = lengths_from(edge_and_crossing_graph(folded(grid, 2.5)), start);
  EXPECT_LT((flat - bent).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(EdgeAndCrossingGraph, CrossesNoEdgeOfThreeFaces) {
  TriangleMesh fins;
  fins.vertices.resize(3, 5);
  fins.vertices << 0, 0, 1, -1, 0,  //
      0, 1, 0.5, 0.5, 0.5,          //
      0, 0, 0, 0, 1;
  fins.faces.resize(3, 2);
  fins.faces << 0, 1, 1, 0, 2, 3;
  EXPECT_DOUBLE_EQ(lengths_from(edge_and_crossing_graph(fins), 2)[3], 2);
  fins.faces.resize(3, 3);
  fins.faces << 0, 1, 0, 1, 0, 1, 2, 3, 4;
  EXPECT_DOUBLE_EQ(lengths_from(edge_and_crossing_graph(fins), 2)[3], 2 * std::hypot(1, 0.5));
}

TEST(PathLengths, AreInfiniteOnOtherComponents) {
  const TriangleMesh two = shapes::joined(shapes::cube(), shapes::cube());
  const Eigen::VectorXd lengths = lengths_from(edge_and_crossing_graph(two), 0);
  EXPECT_TRUE((lengths.head(8).array() < infinity).all());
  EXPECT_TRUE((lengths.tail(8).array() == infinity).all());
}

TEST(ShortestPaths, VisitsTheNearestFirstUpToTheLimitAndForgets) {
  const TriangleMesh grid = shapes::square_grid(4);
  const SurfaceGraph graph = edge_graph(grid);
  ShortestPaths paths(graph);
  const std::vector<PathStart> starts{{grid_vertex(grid, 0, 0), 0.1}, {grid_vertex(grid, 1, 0), 0}};
  for (int call = 0; call < 2; ++call) {
    std::vector<std::pair<int, double>> visited;
    paths.visit_within(starts, 0.2, [&](int vertex, double length) { visited.emplace_back(vertex, length); });
    EXPECT_THAT(visited, ElementsAre(Pair(starts[1].vertex, 0), Pair(starts[0].vertex, 0.1)));
  }
  double last = 0;
  std::size_t count = 0;
  paths.visit_within(starts, infinity, [&](int, double length) {
    EXPECT_GE(length, last);
    last = length;
    ++count;
  });
  EXPECT_EQ(count, static_cast<std::size_t>(grid.vertices.cols()));
}

TEST(PathStarts, LeadFromAPointOfAFaceToAnother) {
  const TriangleMesh grid = shapes::square_grid(squares);
  const ClosestPointTree tree(grid);
  const double edge = 1.0 / squares;
  // Along a row of edges, from the middle of one to the middle of another.
  const auto starts = path_starts(grid, *tree.closest(Vector3(0.5 * edge, 0, 0)));
  const auto ends = path_starts(grid, *tree.closest(Vector3(6.5 * edge, 0, 0)));
  EXPECT_NEAR(length_to(path_lengths(edge_graph(grid), starts), ends), 6 * edge, 1e-9);
}

}  // namespace
}  // namespace bespoke
