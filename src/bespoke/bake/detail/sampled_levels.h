#pragma once

#include <bitset>
#include <cstddef>
#include <memory>
#include <vector>

#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {

struct SampledLevel {
  Lattice lattice;
  std::vector<LeafCoordinates> leaves;  ///< in the order they came
  std::vector<const float*> samples;  ///< u at the nodes of each leaf, as PyramidLevel::values_of, mesh units
  LeafTable table;                    ///< finds the leaves
};

/// The leaves of a nested pyramid in the making with u at their nodes; not residuals, because these change
/// whenever a coarser leaf comes. A leaf below level 0 lies inside a leaf of the level above. Copies share
/// the samples, which are most of the memory.
class SampledLevels {
 public:
  explicit SampledLevels(const Lattice& coarsest) : coarsest_(coarsest) {}

  std::size_t size() const { return levels_.size(); }
  const SampledLevel& operator[](std::size_t level) const { return levels_[level]; }
  bool has(std::size_t level, const LeafCoordinates& leaf) const {
    return level < levels_.size() && levels_[level].table.find(leaf) != no_leaf;
  }
  std::size_t leaf_count() const;

  /// Of levels that have no leaf yet as well.
  Lattice lattice(std::size_t level) const;

  /// `leaves`: none of them there yet, the level above there already. `samples`: u at their nodes in turn.
  void append(std::size_t level, const std::vector<LeafCoordinates>& leaves, std::vector<float> samples);

  /// The leaves of a level, in this order instead, with other values.
  void replace(std::size_t level, std::vector<LeafCoordinates> leaves, std::vector<float> samples);

  /// The sum of the levels down to this one at the nodes of a leaf's block: u where there is a leaf,
  /// interpolated from the levels above elsewhere.
  void sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const;

  /// The same of the levels above only.
  void coarse_sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const;

  /// Which leaves of the block at a leaf (by corner_step) are not there. Outside the band u is zero, so none
  /// is missing at level 0.
  std::bitset<8> missing_in_block(std::size_t level, const LeafCoordinates& leaf) const;

 private:
  using Batch = std::shared_ptr<const std::vector<float>>;

  Lattice coarsest_;
  std::vector<SampledLevel> levels_;
  std::vector<std::vector<Batch>> batches_;  // hold the samples, by level
};

/// |u − sum|² at a place of a leaf whose samples start at `u`.
inline double squared_residual(const float* u, const NodeBlock& sum, const LatticeCoordinates& place) {
  const int node = number_in_block(place);
  const float* value = u + 3 * number_of_place(place);
  double squared = 0;
  for (int c = 0; c < 3; ++c) squared += (value[c] - sum[c][node]) * (value[c] - sum[c][node]);
  return squared;
}

}  // namespace bespoke
