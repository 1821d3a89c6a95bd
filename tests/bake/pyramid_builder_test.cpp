#include "bespoke/bake/detail/pyramid_builder.h"

#include <gmock/gmock.h>

#include <cmath>

#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

// Detail of three sizes: a wide bump, a narrow one on its flank, a tiny one far off.
AnalyticMap three_sizes() {
  return AnalyticMap({{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, 0)},
                      {Vector3(0.6, 0.1, 0), 0.15, Vector3(0, 0.03, 0)},
                      {Vector3(-0.7, 0, 0.3), 0.04, Vector3(0, 0, 0.008)}});
}

constexpr double tolerance = 2e-4;

RefinementOptions options() {
  RefinementOptions options;
  options.tolerance = tolerance;
  options.max_memory = std::size_t{1} << 30;
  return options;
}

Pyramid refined(const AnalyticMap& map, NodeValues nodes) {
  const Progress progress;
  RefinementOptions chosen = options();
  chosen.nodes = nodes;
  PyramidBuilder builder(map, chosen, progress);
  builder.refine();
  return builder.pyramid();
}

// Largest |baked − map| at a node of the pyramid's levels from this one on, by component.
double largest_error_at_nodes(const AnalyticMap& map, const Pyramid& pyramid, std::size_t first_level = 0) {
  const BakedMap baked({}, pyramid);
  double largest = 0;
  for (std::size_t number = first_level; number < pyramid.levels.size(); ++number) {
    const PyramidLevel& level = pyramid.levels[number];
    for (const LeafCoordinates& leaf : level.leaves) {
      Points x(3, leaf_nodes);
      for (int n = 0; n < leaf_nodes; ++n)
        x.col(n) = pyramid.origin + level.voxel_size * as_vector(moved(first_node(leaf), place_of_number(n)));
      largest = std::max(largest, (baked.displacement(x) - map.displacement(x)).cwiseAbs().maxCoeff());
    }
  }
  return largest;
}

TEST(PyramidBuilder, IsNestedAndTakesTheMapsValueAtEveryNodeWhereThatIsSampled) {
  const AnalyticMap map = three_sizes();
  const Pyramid pyramid = refined(map, NodeValues::sampled);
  ASSERT_NO_THROW(require_valid(pyramid));
  EXPECT_GE(pyramid.levels.size(), 5u);
  // Up to the rounding of what is stored, half of a 32nd of the tolerance.
  EXPECT_LT(largest_error_at_nodes(map, pyramid), tolerance / 64 + 1e-7);
}

TEST(PyramidBuilder, MeetsTheToleranceAtFewerNodesWhereTheyAreBalanced) {
  const AnalyticMap map = three_sizes();
  const Pyramid pyramid = refined(map, NodeValues::balanced);
  ASSERT_NO_THROW(require_valid(pyramid));
  EXPECT_LE(largest_error_at_nodes(map, pyramid), tolerance);
  EXPECT_LT(pyramid.leaf_count(), 0.8 * static_cast<double>(refined(map, NodeValues::sampled).leaf_count()));
}

// They do not resolve what is there, so that second differences tell nothing.
TEST(PyramidBuilder, SamplesTheFinestVoxelsThatTheToleranceAllows) {
  const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, 0)},
                         {Vector3(0.6, 0.1, 0), 0.2 * tolerance, Vector3(0, 50 * tolerance, 0)}});
  const Progress progress;
  PyramidBuilder builder(map, options(), progress);
  builder.refine();
  builder.refine_at(Vector3(0.6, 0.1, 0));
  while (builder.pyramid().levels.back().voxel_size >= tolerance)
    ASSERT_GT(builder.refine_at(Vector3(0.6, 0.1, 0)), 0u);
  const Pyramid pyramid = builder.pyramid();
  EXPECT_GE(pyramid.levels.back().voxel_size, tolerance / 2);
  EXPECT_LT(largest_error_at_nodes(map, pyramid, pyramid.levels.size() - 1), tolerance / 64 + 1e-7);
}

TEST(PyramidBuilder, RefinesOnlyWhereTheDetailIs) {
  const AnalyticMap map = three_sizes();
  const Progress progress;
  PyramidBuilder builder(map, options(), progress);
  builder.refine();
  const Pyramid pyramid = builder.pyramid();
  const PyramidLevel& finest = pyramid.levels.back();
  for (const LeafCoordinates& leaf : finest.leaves) {
    const Vector3 middle = pyramid.origin + finest.voxel_size * (8 * Vector3(leaf[0], leaf[1], leaf[2]) +
                                                                 Vector3::Constant(3.5));
    EXPECT_LT((middle - Vector3(-0.7, 0, 0.3)).norm(), 0.15);
  }
}

// What a level adds just inside its level boundary drops to zero within one cell: harmless when it is small,
// or when zero is what the map does.
TEST(PyramidBuilder, GradesEveryRim) {
  const AnalyticMap map = three_sizes();
  const Progress progress;
  PyramidBuilder builder(map, options(), progress);
  builder.refine();
  const Pyramid pyramid = builder.pyramid();
  for (std::size_t number = 1; number < pyramid.levels.size(); ++number) {
    const PyramidLevel& level = pyramid.levels[number];
    const LeafTable table(level.leaves);
    const double limit = std::min(tolerance, 0.3 * level.voxel_size);
    for (std::size_t leaf = 0; leaf < level.leaves.size(); ++leaf)
      for (int n = 0; n < leaf_nodes; ++n) {
        const std::array<int, 3> node = {n / 64, n / 8 % 8, n % 8};
        bool at_rim = false;
        for (int side = 0; side < 27; ++side) {
          LeafCoordinates reached;
          for (int axis = 0, power = 9; axis < 3; ++axis, power /= 3)
            reached[axis] = (8 * level.leaves[leaf][axis] + node[axis] + side / power % 3 - 1) >> 3;
          if (table.find(reached) != no_leaf) continue;
          const Vector3 step(side / 9 - 1, side / 3 % 3 - 1, side % 3 - 1);
          const Vector3 place(8 * level.leaves[leaf][0] + node[0], 8 * level.leaves[leaf][1] + node[1],
                              8 * level.leaves[leaf][2] + node[2]);
          const Vector3 beyond = pyramid.origin + level.voxel_size * (place + step);
          at_rim = at_rim || !map.displacement(beyond).isZero(0);
        }
        if (!at_rim) continue;
        const float* r = &level.values[3 * (leaf * leaf_nodes + static_cast<std::size_t>(n))];
        ASSERT_LE(std::hypot(r[0], r[1], r[2]), limit * 1.0001);
      }
  }
}

TEST(PyramidBuilder, RefinesWhereItIsTold) {
  const AnalyticMap map = three_sizes();
  const Progress progress;
  PyramidBuilder builder(map, options(), progress);
  builder.refine();
  const std::size_t before = builder.pyramid().voxel_count();
  EXPECT_EQ(builder.refine_at(Vector3(100, 100, 100)), 0u);
  EXPECT_GT(builder.refine_at(Vector3(0.1, 0.1, 0.1)), 0u);
  builder.refine();
  EXPECT_GT(builder.pyramid().voxel_count(), before);
  EXPECT_NO_THROW(require_valid(builder.pyramid()));
}

TEST(PyramidBuilder, RefusesMemoryAndSaysWhichToleranceFits) {
  const AnalyticMap map = three_sizes();
  const Progress progress;
  RefinementOptions limited = options();
  limited.tolerance = 1e-6;
  limited.max_memory = std::size_t{60} << 20;
  std::string message;
  try {
    PyramidBuilder builder(map, limited, progress);
    builder.refine();
  } catch (const MemoryLimitError& error) {
    message = error.what();
  }
  const std::string before = "; a tolerance of ";
  const std::size_t at = message.find(before);
  ASSERT_NE(at, std::string::npos) << message;
  limited.tolerance = std::stod(message.substr(at + before.size()));
  PyramidBuilder builder(map, limited, progress);
  EXPECT_NO_THROW(builder.refine()) << message;
  EXPECT_LE(builder.byte_count(), limited.max_memory);
}

}  // namespace
}  // namespace bespoke
