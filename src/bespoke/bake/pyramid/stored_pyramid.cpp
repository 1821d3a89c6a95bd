#include "bespoke/bake/pyramid/stored_pyramid.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "bespoke/bake/pyramid/leaf_samples.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Numbers of the leaves in lexicographic order.
std::vector<std::size_t> lexicographic(const std::vector<LeafCoordinates>& leaves) {
  std::vector<std::size_t> order(leaves.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return leaves[a] < leaves[b]; });
  return order;
}

double coarse_value(const NodeBlock& coarse, int node, int component) {
  return coarse[component][number_in_block(place_of_number(node))];
}

void store_residuals(const LeafValues& values, const NodeBlock& coarse, float* stored) {
  for (int node = 0; node < leaf_nodes; ++node)
    for (int c = 0; c < 3; ++c)
      stored[3 * node + c] =
          static_cast<float>(values[static_cast<std::size_t>(3 * node + c)] - coarse_value(coarse, node, c));
}

void add_residuals(const float* stored, const NodeBlock& coarse, float* sum) {
  for (int node = 0; node < leaf_nodes; ++node)
    for (int c = 0; c < 3; ++c)
      sum[3 * node + c] = static_cast<float>(coarse_value(coarse, node, c) + stored[3 * node + c]);
}

// `levels` holds at the coarser levels what is stored there, and afterwards at this one as well, unless
// nothing follows it.
PyramidLevel store_level(SampledLevels& levels, std::size_t level, double tolerance,
                         ValuePrecision precision) {
  const SampledLevel& from = levels[level];
  const std::vector<std::size_t> order = lexicographic(from.leaves);
  const bool is_last = level + 1 == levels.size();
  PyramidLevel stored;
  stored.voxel_size = from.lattice.voxel_size;
  for (const std::size_t n : order) stored.leaves.push_back(from.leaves[n]);
  stored.values.resize(leaf_floats * order.size());
  std::vector<float> sums(is_last ? 0 : stored.values.size());
  parallel_for(order.size(), 16, [&](std::size_t begin, std::size_t end) {
    NodeBlock coarse;
    for (std::size_t n = begin; n < end; ++n) {
      levels.coarse_sum_at(level, stored.leaves[n], coarse);
      store_residuals(*from.values[order[n]], coarse, stored.values_of(n));
      round_values({stored.values_of(n), leaf_floats}, tolerance, precision);
      if (!is_last) add_residuals(stored.values_of(n), coarse, &sums[leaf_floats * n]);
    }
  });
  if (!is_last) levels.replace(level, stored.leaves, sums);
  return stored;
}

bool has_child(const LeafTable& finer, const LeafCoordinates& leaf) {
  for (int octant = 0; octant < 8; ++octant)
    if (finer.find(child_of(leaf, octant)) != no_leaf) return true;
  return false;
}

void drop_empty_leaves(Pyramid& pyramid) {
  LeafTable finer;
  for (std::size_t level = pyramid.levels.size(); level-- > 0;) {
    keep_leaves(pyramid.levels[level],
                [&](const LeafCoordinates& leaf, bool zero) { return !zero || has_child(finer, leaf); });
    finer = LeafTable(pyramid.levels[level].leaves);
  }
  while (!pyramid.levels.empty() && pyramid.levels.back().leaves.empty()) pyramid.levels.pop_back();
}

}  // namespace

Pyramid stored_pyramid(SampledLevels levels, double tolerance, ValuePrecision precision) {
  Pyramid pyramid;
  pyramid.origin = levels.lattice(0).origin;
  pyramid.precision = precision;
  for (std::size_t level = 0; level < levels.size(); ++level)
    pyramid.levels.push_back(store_level(levels, level, tolerance, precision));
  drop_empty_leaves(pyramid);
  return pyramid;
}

}  // namespace bespoke
