#pragma once

#include <bitset>
#include <cstddef>
#include <memory>
#include <vector>

#include "bespoke/bake/node_values.h"
#include "bespoke/bake/pyramid/balanced_values.h"
#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {

struct SampledLevel {
  Lattice lattice;
  std::vector<LeafCoordinates> leaves;                     ///< in the order they came
  std::vector<std::shared_ptr<const LeafValues>> samples;  ///< u at the nodes of each leaf, mesh units
  std::vector<std::shared_ptr<const LeafValues>> values;   ///< of the sum of the levels there
  LeafTable table;                                         ///< finds the leaves
};

/// The leaves of a nested pyramid in the making with u at their nodes, and what the sum of the levels down to
/// theirs is there; not residuals, because these change whenever a coarser leaf comes. The values follow from
/// the leaves of a level, not from the order in which they came. A leaf below level 0 lies inside a leaf of
/// the level above. Copies share samples and values, which are most of the memory.
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
  /// `nodes`: always the same for a level.
  void append(std::size_t level, const std::vector<LeafCoordinates>& leaves,
              const std::vector<float>& samples, NodeValues nodes);

  /// The leaves of a level, in this order instead, with other values and without samples.
  void replace(std::size_t level, const std::vector<LeafCoordinates>& leaves,
               const std::vector<float>& values);

  /// The sum of the levels down to this one at the nodes of a leaf's block: its values where there is a leaf,
  /// interpolated from the levels above elsewhere.
  void sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const;

  /// The same of the levels above only.
  void coarse_sum_at(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const;

  /// Which leaves of the block at a leaf (by corner_step) are not there. Outside the band u is zero, so none
  /// is missing at level 0.
  std::bitset<8> missing_in_block(std::size_t level, const LeafCoordinates& leaf) const;

 private:
  LeafSurroundings surroundings(const SampledLevel& level, std::size_t leaf) const;
  void balance_from(SampledLevel& level, std::size_t first) const;

  Lattice coarsest_;
  std::vector<SampledLevel> levels_;
};

/// |value − sum|² at a place of a leaf of these values.
inline double squared_residual(const LeafValues& values, const NodeBlock& sum,
                               const LatticeCoordinates& place) {
  const int node = number_in_block(place);
  const float* value = values.data() + 3 * number_of_place(place);
  double squared = 0;
  for (int c = 0; c < 3; ++c) squared += (value[c] - sum[c][node]) * (value[c] - sum[c][node]);
  return squared;
}

}  // namespace bespoke
