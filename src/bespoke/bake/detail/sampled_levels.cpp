#include "bespoke/bake/detail/sampled_levels.h"

#include <cmath>
#include <utility>

namespace bespoke {

std::size_t SampledLevels::leaf_count() const {
  std::size_t leaves = 0;
  for (const SampledLevel& level : levels_) leaves += level.leaves.size();
  return leaves;
}

Lattice SampledLevels::lattice(std::size_t level) const {
  return {coarsest_.origin, std::ldexp(coarsest_.voxel_size, -static_cast<int>(level))};
}

void SampledLevels::append(std::size_t level, const std::vector<LeafCoordinates>& leaves,
                           std::vector<float> samples) {
  while (levels_.size() <= level) {
    levels_.push_back({lattice(levels_.size()), {}, {}, {}});
    batches_.emplace_back();
  }
  SampledLevel& to = levels_[level];
  const auto batch = std::make_shared<const std::vector<float>>(std::move(samples));
  batches_[level].push_back(batch);
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    to.table.insert(leaves[n], static_cast<std::int32_t>(to.leaves.size()));
    to.leaves.push_back(leaves[n]);
    to.samples.push_back(batch->data() + leaf_floats * n);
  }
}

void SampledLevels::replace(std::size_t level, std::vector<LeafCoordinates> leaves,
                            std::vector<float> samples) {
  levels_[level] = {lattice(level), {}, {}, {}};
  batches_[level].clear();
  append(level, leaves, std::move(samples));
}

void SampledLevels::sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const {
  const SampledLevel& at = levels_[level];
  std::array<const float*, 8> blocks{};
  bool complete = true;
  for (int block = 0; block < 8; ++block) {
    const int found = at.table.find(moved(leaf, corner_step(block)));
    if (found != no_leaf) blocks[block] = at.samples[static_cast<std::size_t>(found)];
    complete = complete && found != no_leaf;
  }
  // Samples are of the whole u, so a leaf of this level needs no coarser one; only where one of the eight
  // leaves around the block is missing does the sum of the coarser levels stand in.
  if (!complete) coarse_sum_at(level, leaf, sum);
  for (int node = 0; node < block_nodes; ++node) {
    const BlockValue from = block_values[node];
    if (const float* block = blocks[from.leaf])
      for (int c = 0; c < 3; ++c) sum[c][node] = block[from.offset + c];
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
