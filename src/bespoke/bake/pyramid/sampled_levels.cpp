#include "bespoke/bake/pyramid/sampled_levels.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

LeafCoordinates beside_along(LeafCoordinates leaf, std::size_t axis, int step) {
  leaf[axis] += step;
  return leaf;
}

// After those that the level has.
void put_leaves(const std::vector<LeafCoordinates>& leaves, const std::vector<float>& numbers,
                SampledLevel& level, std::vector<std::shared_ptr<const LeafValues>>& to) {
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    auto values = std::make_shared<LeafValues>();
    std::copy_n(&numbers[leaf_floats * n], leaf_floats, values->begin());
    level.table.insert(leaves[n], static_cast<std::int32_t>(level.leaves.size()));
    level.leaves.push_back(leaves[n]);
    to.push_back(std::move(values));
  }
}

}  // namespace

std::size_t SampledLevels::leaf_count() const {
  std::size_t leaves = 0;
  for (const SampledLevel& level : levels_) leaves += level.leaves.size();
  return leaves;
}

Lattice SampledLevels::lattice(std::size_t level) const {
  return {coarsest_.origin, std::ldexp(coarsest_.voxel_size, -static_cast<int>(level))};
}

void SampledLevels::append(std::size_t level, const std::vector<LeafCoordinates>& leaves,
                           const std::vector<float>& samples, NodeValues nodes) {
  while (levels_.size() <= level) levels_.push_back({lattice(levels_.size()), {}, {}, {}, {}});
  SampledLevel& to = levels_[level];
  const std::size_t first = to.leaves.size();
  put_leaves(leaves, samples, to, to.samples);
  if (nodes == NodeValues::sampled)
    to.values = to.samples;
  else
    balance_from(to, first);
}

void SampledLevels::replace(std::size_t level, const std::vector<LeafCoordinates>& leaves,
                            const std::vector<float>& values) {
  levels_[level] = {lattice(level), {}, {}, {}, {}};
  put_leaves(leaves, values, levels_[level], levels_[level].values);
}

// Of the leaves from number `first` on, and of those across their faces, which these may have completed.
void SampledLevels::balance_from(SampledLevel& level, std::size_t first) const {
  level.values.resize(level.leaves.size());
  std::vector<std::size_t> changed;
  for (std::size_t leaf = first; leaf < level.leaves.size(); ++leaf) {
    changed.push_back(leaf);
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int step : {-1, 1})
        if (const int beside = level.table.find(beside_along(level.leaves[leaf], axis, step));
            beside != no_leaf && static_cast<std::size_t>(beside) < first)
          changed.push_back(static_cast<std::size_t>(beside));
  }
  std::sort(changed.begin(), changed.end());
  changed.erase(std::unique(changed.begin(), changed.end()), changed.end());
  parallel_for(changed.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      level.values[changed[n]] = balanced_values(surroundings(level, changed[n]));
  });
}

LeafSurroundings SampledLevels::surroundings(const SampledLevel& level, std::size_t leaf) const {
  LeafSurroundings u{level.samples[leaf].get(), {}};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t upper = 0; upper < 2; ++upper)
      if (const int found = level.table.find(beside_along(level.leaves[leaf], axis, upper ? 1 : -1));
          found != no_leaf)
        u.beside[axis][upper] = level.samples[static_cast<std::size_t>(found)].get();
  return u;
}

void SampledLevels::sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const {
  const SampledLevel& at = levels_[level];
  std::array<const LeafValues*, 8> blocks{};
  bool complete = true;
  for (int block = 0; block < 8; ++block) {
    const int found = at.table.find(moved(leaf, corner_step(block)));
    if (found != no_leaf) blocks[block] = at.values[static_cast<std::size_t>(found)].get();
    complete = complete && found != no_leaf;
  }
  // Values are of the whole u, so a leaf of this level needs no coarser one; only where one of the eight
  // leaves around the block is missing does the sum of the coarser levels stand in.
  if (!complete) coarse_sum_at(level, leaf, sum);
  for (int node = 0; node < block_nodes; ++node) {
    const BlockValue from = block_values[node];
    if (const LeafValues* block = blocks[from.leaf])
      for (int c = 0; c < 3; ++c) sum[c][node] = block->data()[from.offset + c];
  }
}

void SampledLevels::coarse_sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const {
  if (level == 0) {
    for (auto& component : sum) component.fill(0);
    return;
  }
  NodeBlock coarse;
  sum_at(level - 1, parent_of(leaf), coarse);
  refine_block(coarse, octant_in_parent(leaf), sum);
}

std::bitset<8> SampledLevels::missing_in_block(std::size_t level, const LeafCoordinates& leaf) const {
  std::bitset<8> missing;
  if (level == 0) return missing;
  for (int block = 1; block < 8; ++block)
    missing[static_cast<std::size_t>(block)] = !has(level, moved(leaf, corner_step(block)));
  return missing;
}

}  // namespace bespoke
