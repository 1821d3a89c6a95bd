#include "bespoke/bake/detail/pyramid_builder.h"

#include <algorithm>
#include <limits>
#include <set>
#include <tuple>
#include <utility>

#include "bespoke/bake/band.h"
#include "bespoke/bake/pyramid/leaf_samples.h"
#include "bespoke/bake/pyramid/level_boundaries.h"
#include "bespoke/bake/pyramid/stored_pyramid.h"
#include "bespoke/mapping/affine_map.h"

namespace bespoke {
namespace {

// Voxels of the coarsest level in the radius of the largest ball.
constexpr double coarsest_voxels_per_radius = 4;
// One of so many leaves is kept for folds and faces that turn.
constexpr std::size_t share_in_reserve = 10;

// Before its frame.
double largest_radius(const Support& support) {
  double radius = 0;
  for (const BallCloud& cloud : support.clouds)
    if (cloud.centers.cols() > 0) radius = std::max(radius, cloud.radius);
  return radius / power_of_two_scale(support.frame);
}

Lattice coarsest_lattice(const Support& support) {
  return {bounding_box(support).min(), largest_radius(support) / coarsest_voxels_per_radius};
}

}  // namespace

PyramidBuilder::PyramidBuilder(const ElasticMap& map, const RefinementOptions& options,
                               const Progress& progress)
    : map_(map),
      options_(options),
      rim_tolerance_(options.tolerance_of_values()),
      progress_(progress),
      coarsest_(coarsest_lattice(map.support())),
      band_(band_leaves(map.support(), coarsest_)),
      levels_(coarsest_),
      octants_(map, options, progress),
      budget_(map, coarsest_, band_, options, progress),
      reserve_(options.max_leaves.value_or(0) / share_in_reserve) {
  add(0, band_);
}

void PyramidBuilder::refine() {
  do {
    while (const std::optional<std::size_t> level = first_untested_level()) {
      progress_.check();
      refine_level(*level);
    }
  } while (add_worst_refused());
}

void PyramidBuilder::refine_level(std::size_t level) {
  const std::size_t first = std::exchange(looked_[level].leaves, levels_[level].leaves.size());
  if (is_finest(level)) return;
  const std::vector<FailingOctant> failing = octants_.failing_octants(levels_, level, first);
  // Several times as many may be added at level boundaries.
  const bool affordable = refused_.empty() && failing.size() <= leaves_left(Purpose::tolerance) / 8;
  if (!affordable) {
    refuse(level + 1, failing);
    return;
  }
  std::vector<LeafCoordinates> leaves;
  for (const FailingOctant& octant : failing) leaves.push_back(octant.leaf);
  add(level + 1, std::move(leaves));
  close_rims();
}

// Until add_worst_refused finds a leaf for them.
void PyramidBuilder::refuse(std::size_t level, const std::vector<FailingOctant>& octants) {
  std::vector<LeafCoordinates> leaves;
  for (const FailingOctant& octant : octants) leaves.push_back(octant.leaf);
  if (options_.surface && !nearness_) nearness_ = std::make_shared<const Nearness>(*options_.surface);
  const std::vector<double> weights =
      nearness_ ? nearness_->weights(levels_.lattice(level), leaves) : std::vector<double>(leaves.size(), 1);
  for (std::size_t n = 0; n < octants.size(); ++n)
    refused_.push_back({level, leaves[n], octants[n].error, weights[n] * octants[n].error});
}

// What is left goes to the worst in rounds.
bool PyramidBuilder::add_worst_refused() {
  std::erase_if(refused_,
                [&](const RefusedOctant& octant) { return levels_.has(octant.level, octant.leaf); });
  const std::size_t left = leaves_left(Purpose::tolerance);
  if (refused_.empty() || left == 0) return false;
  double largest = 0;
  for (const RefusedOctant& octant : refused_) largest = std::max(largest, octant.urgency);
  // Level boundaries as fine as the tolerance would cover all that fails.
  rim_tolerance_ = std::max(largest / 2, options_.tolerance) / options_.growth_after;
  for (Looked& looked : looked_) looked.rims_known = false;
  std::vector<std::vector<LeafCoordinates>> wanted(levels_.size() + 1);
  for (const RefusedOctant& octant : worst_refused(std::max<std::size_t>(1, left / 16)))
    wanted[octant.level].push_back(octant.leaf);
  for (std::size_t level = 1; level < wanted.size(); ++level) add(level, std::move(wanted[level]));
  close_rims();
  return true;
}

// Those above half of the largest. Rounds take turns: errors as they are, without which a few steep places
// fold or flip faces, and errors times the size of a voxel, without which these places take all.
std::vector<RefusedOctant> PyramidBuilder::worst_refused(std::size_t most) {
  const bool by_size = std::exchange(next_by_size_, !next_by_size_);
  const auto rank = [&](const RefusedOctant& octant) {
    return octant.urgency * (by_size ? levels_.lattice(octant.level).voxel_size : 1);
  };
  std::sort(refused_.begin(), refused_.end(), [&](const RefusedOctant& a, const RefusedOctant& b) {
    const double rank_a = rank(a), rank_b = rank(b);
    return rank_a != rank_b ? rank_a > rank_b : std::tie(a.level, a.leaf) < std::tie(b.level, b.leaf);
  });
  const double least = rank(refused_.front()) / 2;
  std::vector<RefusedOctant> worst;
  for (std::size_t n = 0; n < std::min(most, refused_.size()) && rank(refused_[n]) >= least; ++n)
    worst.push_back(refused_[n]);
  return worst;
}

std::size_t PyramidBuilder::leaves_left(Purpose purpose) const {
  if (!options_.max_leaves) return std::numeric_limits<std::size_t>::max();
  const std::size_t most = *options_.max_leaves - (purpose == Purpose::reserved ? 0 : reserve_);
  return most - std::min(most, levels_.leaf_count());
}

bool PyramidBuilder::free_reserve() {
  return std::exchange(reserve_, 0) > 0 && leaves_left(Purpose::tolerance) > 0 && !refused_.empty();
}

std::vector<RelaxedRegion> PyramidBuilder::relaxed() const {
  std::vector<RefusedOctant> left;
  for (const RefusedOctant& octant : refused_)
    if (!levels_.has(octant.level, octant.leaf)) left.push_back(octant);
  return relaxed_regions(coarsest_, left);
}

// Neighbours and the leaves above them may change the level boundaries of every level, so each is looked at
// again.
void PyramidBuilder::close_rims() {
  while (const std::optional<std::size_t> level = first_level_of_unknown_rims()) {
    looked_[*level].rims_known = true;
    add(*level, rims_within_budget(*level));
  }
}

// Level boundaries that fold are closed in any case.
std::vector<LeafCoordinates> PyramidBuilder::rims_within_budget(std::size_t level) {
  std::vector<LeafCoordinates> leaves = rim_neighbours(levels_, level, rim_tolerance_, options_.growth);
  while (leaves.size() > leaves_left(Purpose::reserved) &&
         rim_tolerance_ < rim_gradient * options_.growth * levels_.lattice(level).voxel_size) {
    rim_tolerance_ *= 2;
    leaves = rim_neighbours(levels_, level, rim_tolerance_, options_.growth);
  }
  return leaves;
}

std::optional<std::size_t> PyramidBuilder::first_untested_level() const {
  for (std::size_t level = 0; level < levels_.size(); ++level)
    if (looked_[level].leaves < levels_[level].leaves.size()) return level;
  return std::nullopt;
}

// Beyond the level boundary of level 0 u is zero.
std::optional<std::size_t> PyramidBuilder::first_level_of_unknown_rims() const {
  for (std::size_t level = 1; level < levels_.size(); ++level)
    if (!looked_[level].rims_known) return level;
  return std::nullopt;
}

// With the leaves above them, coarse ones first.
void PyramidBuilder::add(std::size_t level, std::vector<LeafCoordinates> leaves) {
  leaves = unique_leaves(std::move(leaves));
  std::erase_if(leaves, [&](const LeafCoordinates& leaf) { return levels_.has(level, leaf); });
  if (leaves.empty()) return;
  if (level > 0) {
    std::vector<LeafCoordinates> parents;
    for (const LeafCoordinates& leaf : leaves) parents.push_back(parent_of(leaf));
    add(level - 1, std::move(parents));
  }
  budget_.require_space_for(levels_.leaf_count() + leaves.size());
  levels_.append(level, leaves, sample_leaves(map_, levels_.lattice(level), leaves, progress_),
                 nodes_of(level));
  sampled_points_ += leaves.size() * leaf_nodes;
  looked_.resize(levels_.size());
  for (std::size_t finer = level; finer < levels_.size(); ++finer) looked_[finer].rims_known = false;
}

// What the finest voxels do not resolve bends by more than second differences tell, and no finer level takes
// back what balancing adds there: a cell of a head folded, which no leaf could repair.
NodeValues PyramidBuilder::nodes_of(std::size_t level) const {
  return is_finest(level) ? NodeValues::sampled : options_.nodes;
}

bool PyramidBuilder::is_finest(std::size_t level) const {
  return levels_.lattice(level + 1).voxel_size < min_voxel();
}

std::size_t PyramidBuilder::refine_at(const Points& x, Purpose purpose) {
  const std::size_t most = leaves_left(purpose);
  std::set<WantedLeaf> known;
  std::vector<std::vector<LeafCoordinates>> wanted(levels_.size() + 1);
  for (Eigen::Index i = 0; i < x.cols() && known.size() < most; ++i)
    for (const WantedLeaf& leaf : leaves_wanted_at(x.col(i)))
      if (known.insert(leaf).second) wanted[leaf.level].push_back(leaf.leaf);
  const std::size_t before = levels_.leaf_count();
  for (std::size_t level = 1; level < wanted.size(); ++level) add(level, std::move(wanted[level]));
  close_rims();
  return levels_.leaf_count() - before;
}

// In a cell at a level boundary the leaves beyond the level boundary, elsewhere a finer one.
std::vector<PyramidBuilder::WantedLeaf> PyramidBuilder::leaves_wanted_at(const Vector3& x) const {
  for (std::size_t level = levels_.size(); level-- > 0;) {
    const LatticeCoordinates cell = levels_[level].lattice.cell_of(x);
    const LeafCoordinates leaf = leaf_of(cell);
    if (!levels_.has(level, leaf)) continue;
    const std::bitset<8> missing = levels_.missing_in_block(level, leaf);
    std::vector<WantedLeaf> wanted;
    for (int block = 1; block < 8; ++block)
      if (missing[static_cast<std::size_t>(block)] && cell_reaches(place_in_leaf(cell), block))
        wanted.push_back({level, moved(leaf, corner_step(block))});
    if (wanted.empty() && !is_finest(level))
      wanted.push_back({level + 1, child_of(leaf, octant_of_cell(cell))});
    return wanted;
  }
  return {};
}

Pyramid PyramidBuilder::pyramid() const {
  return stored_pyramid(levels_, options_.tolerance_of_values(), options_.precision);
}

std::size_t PyramidBuilder::evaluated_points() const {
  return sampled_points_ + octants_.evaluated_points() + budget_.evaluated_points();
}

}  // namespace bespoke
