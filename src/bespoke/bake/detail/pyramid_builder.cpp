#include "bespoke/bake/detail/pyramid_builder.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <span>
#include <string>

#include "bespoke/bake/detail/octant_test.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// η of src/bespoke/README.md, "Bake": a rim may add this much to the gradient.
constexpr double rim_gradient = 0.3;
// Voxels of the coarsest level in the radius of the largest ball.
constexpr double coarsest_voxels_per_radius = 4;
// Halving the voxels divides a residual by four once they resolve the map; with less in a radius they may
// not.
constexpr double resolving_voxels_per_radius = 4;

constexpr std::size_t points_per_call = 1 << 16;
// Four arrays of values at most: the samples, a pyramid, the one that may replace it, and the stored sums
// that the latter's residuals are taken against; coordinates, tables, and the index that the look-up needs
// (measured: up to 8 entries of 112 bytes for a leaf that stands alone).
constexpr std::size_t bytes_per_leaf = 4 * 3 * leaf_nodes * sizeof(float) + 1500;
constexpr std::size_t fixed_bytes = std::size_t{48} << 20;
// Below this many leaves a forecast costs more than it may save.
constexpr std::size_t leaves_without_forecast = 4096;
// A forecast errs: advice keeps this distance from the limit.
constexpr double advice_margin = 1.6;

int octant_number(const LeafCoordinates& leaf) {
  return (leaf[0] & 1) << 2 | (leaf[1] & 1) << 1 | (leaf[2] & 1);
}

LeafCoordinates parent_of(const LeafCoordinates& leaf) { return {leaf[0] >> 1, leaf[1] >> 1, leaf[2] >> 1}; }

LeafCoordinates moved(const LeafCoordinates& leaf, int i, int j, int k) {
  return {leaf[0] + i, leaf[1] + j, leaf[2] + k};
}

void sort_unique(std::vector<LeafCoordinates>& leaves) {
  std::sort(leaves.begin(), leaves.end());
  leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
}

double largest_radius(const Support& support) {
  double radius = 0;
  for (const BallCloud& cloud : support.clouds)
    if (cloud.centers.cols() > 0) radius = std::max(radius, cloud.radius);
  return radius;
}

// Blocks around a leaf (numbered as octants) that hold a corner of one of its cells.
bool reaches_block(const std::array<int, 3>& cell, int block) {
  for (int axis = 0; axis < 3; ++axis)
    if ((block >> (2 - axis) & 1) && cell[axis] != leaf_edge - 1) return false;
  return true;
}

// A cell at a rim, where the error is the one that the leaf beyond was allowed to keep: a finer leaf on this
// side would not mend it, and would have a rim of its own.
bool touches(const std::bitset<8>& missing, const std::array<int, 3>& cell) {
  for (int block = 1; block < 8; ++block)
    if (missing[static_cast<std::size_t>(block)] && reaches_block(cell, block)) return true;
  return false;
}

// The tested cell in its leaf.
std::array<int, 3> cell_of_octant(const LeafCoordinates& octant, int number) {
  return {4 * (octant[0] & 1) + number / 16, 4 * (octant[1] & 1) + number / 4 % 4,
          4 * (octant[2] & 1) + number % 4};
}

Vector3 value_at(const NodeBlock& block, const std::array<int, 3>& node) {
  const int n = (node[0] * block_edge + node[1]) * block_edge + node[2];
  return {block[0][n], block[1][n], block[2][n]};
}

double squared_residual(const float* u, const NodeBlock& sum, int i, int j, int k) {
  const int n = (i * block_edge + j) * block_edge + k;
  const float* value = u + node_offset(i, j, k);
  double squared = 0;
  for (int c = 0; c < 3; ++c) squared += (value[c] - sum[c][n]) * (value[c] - sum[c][n]);
  return squared;
}

}  // namespace

PyramidBuilder::PyramidBuilder(const ElasticMap& map, const RefinementOptions& options,
                               const Progress& progress)
    : map_(map), options_(options), progress_(progress), support_(map.support()) {
  coarsest_ = {bounding_box(support_).min(), largest_radius(support_) / coarsest_voxels_per_radius};
  make_level(0);
  band_ = band_leaves(support_, coarsest_);
  add(0, band_);
}

std::size_t PyramidBuilder::leaf_count() const {
  std::size_t leaves = 0;
  for (const Level& level : levels_) leaves += level.leaves.size();
  return leaves;
}

std::size_t PyramidBuilder::byte_count() const { return fixed_bytes + bytes_per_leaf * leaf_count(); }

bool PyramidBuilder::is_finest(std::size_t level) const {
  return std::ldexp(coarsest_.voxel_size, -static_cast<int>(level) - 1) <
         least_voxel_of_tolerance * options_.tolerance;
}

void PyramidBuilder::require_room(std::size_t leaves) {
  const std::size_t needed = byte_count() + bytes_per_leaf * leaves;
  const double room =
      (static_cast<double>(options_.max_memory) - static_cast<double>(fixed_bytes)) / bytes_per_leaf;
  const bool small = leaf_count() + leaves <= leaves_without_forecast && needed <= options_.max_memory / 16;
  double expected = 0;
  if (!small && !band_.empty()) {
    if (!forecast_) {
      forecast_ = std::make_shared<LeafForecast>(map_, coarsest_, band_, options_.tolerance, progress_);
      evaluated_points_ += forecast_->evaluated_points();
    }
    expected = forecast_->leaves(options_.tolerance);
  }
  if (needed <= options_.max_memory && expected <= room) return;
  const double bytes =
      std::max(static_cast<double>(needed), static_cast<double>(fixed_bytes) + bytes_per_leaf * expected);
  char text[300];
  int length = std::snprintf(
      text, sizeof text, "a tolerance of %.4g needs about %.0f MB for the bake, the limit is %.0f MB",
      options_.tolerance, std::ceil(bytes / 0x1p20), static_cast<double>(options_.max_memory) / 0x1p20);
  // Where the forecast was too low, what it says about other tolerances is too low as well.
  const double shortfall =
      expected > 0 ? std::max(1.0, static_cast<double>(leaf_count() + leaves) / expected) : 1;
  const std::optional<double> fitting =
      forecast_ ? forecast_->tolerance_for(room / (advice_margin * shortfall)) : std::nullopt;
  if (fitting)
    std::snprintf(text + length, sizeof text - static_cast<std::size_t>(length),
                  "; a tolerance of %.4g would fit", std::max(1.01 * *fitting, 1.1 * options_.tolerance));
  else
    std::snprintf(
        text + length, sizeof text - static_cast<std::size_t>(length),
        "; no tolerance fits, allow at least %.0f MB",
        std::ceil((fixed_bytes + 2.0 * bytes_per_leaf * static_cast<double>(std::max(band_.size(), leaves))) /
                  0x1p20));
  throw MemoryLimitError(text);
}

PyramidBuilder::Level& PyramidBuilder::make_level(std::size_t level) {
  while (levels_.size() <= level) {
    Level made;
    made.lattice = {coarsest_.origin, std::ldexp(coarsest_.voxel_size, -static_cast<int>(levels_.size()))};
    levels_.push_back(std::move(made));
  }
  return levels_[level];
}

void PyramidBuilder::add(std::size_t level, std::vector<LeafCoordinates> leaves) {
  sort_unique(leaves);
  Level& grown = make_level(level);
  std::erase_if(leaves, [&](const LeafCoordinates& leaf) { return grown.table.find(leaf) != no_leaf; });
  if (leaves.empty()) return;
  if (level > 0) {
    std::vector<LeafCoordinates> parents;
    for (const LeafCoordinates& leaf : leaves) parents.push_back(parent_of(leaf));
    add(level - 1, std::move(parents));
  }
  require_room(leaves.size());
  const auto batch = std::make_shared<const std::vector<float>>(
      sample_leaves(map_, levels_[level].lattice, leaves, progress_));
  evaluated_points_ += leaves.size() * leaf_nodes;
  Level& target = levels_[level];
  target.batches.push_back(batch);
  for (std::size_t n = 0; n < leaves.size(); ++n) {
    target.table.insert(leaves[n], static_cast<std::int32_t>(target.leaves.size()));
    target.leaves.push_back(leaves[n]);
    target.samples.push_back(batch->data() + 3 * leaf_nodes * n);
  }
  for (std::size_t finer = level; finer < levels_.size(); ++finer) levels_[finer].rims_known = false;
}

void PyramidBuilder::sum_block(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const {
  const Level& at = levels_[level];
  std::array<const float*, 8> blocks;
  bool complete = true;
  for (int octant = 0; octant < 8; ++octant) {
    const int found = at.table.find(moved(leaf, octant >> 2 & 1, octant >> 1 & 1, octant & 1));
    blocks[octant] = found == no_leaf ? nullptr : at.samples[static_cast<std::size_t>(found)];
    complete = complete && found != no_leaf;
  }
  if (!complete) coarse_block(level, leaf, sum);
  int node = 0;
  for (int i = 0; i < block_edge; ++i)
    for (int j = 0; j < block_edge; ++j)
      for (int k = 0; k < block_edge; ++k, ++node)
        if (const float* block = blocks[(i >> 3) << 2 | (j >> 3) << 1 | k >> 3])
          for (int c = 0; c < 3; ++c) sum[c][node] = block[node_offset(i & 7, j & 7, k & 7) + c];
}

// The sum of the levels above.
void PyramidBuilder::coarse_block(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const {
  if (level == 0) {
    for (auto& component : sum) component.fill(0);
    return;
  }
  NodeBlock coarse;
  sum_block(level - 1, parent_of(leaf), coarse);
  refine_block(coarse, octant_number(leaf), sum);
}

// Octants of untested leaves, except those whose residual says that the error is far below the tolerance.
std::vector<LeafCoordinates> PyramidBuilder::octants_in_question(std::size_t level) const {
  const Level& at = levels_[level];
  Support unresolved;
  unresolved.frame = support_.frame;
  for (const BallCloud& cloud : support_.clouds)
    if (cloud.radius < resolving_voxels_per_radius * at.lattice.voxel_size)
      unresolved.clouds.push_back(cloud);
  const LeafTable surprising(level == 0 ? std::vector<LeafCoordinates>{}
                                        : band_leaves(unresolved, at.lattice));
  const std::size_t first = at.tested;
  const std::size_t count = at.leaves.size() - first;
  std::vector<std::uint8_t> asked(count, 0);
  parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
    NodeBlock coarse;
    for (std::size_t n = begin; n < end; ++n) {
      const LeafCoordinates& leaf = at.leaves[first + n];
      if (level == 0 || surprising.find(leaf) != no_leaf) {
        asked[n] = 0xFF;
        continue;
      }
      coarse_block(level, leaf, coarse);
      const float* u = at.samples[first + n];
      const double limit = options_.tolerance * options_.tolerance;
      for (int i = 0; i < leaf_edge; ++i)
        for (int j = 0; j < leaf_edge; ++j)
          for (int k = 0; k < leaf_edge; ++k)
            if (!(squared_residual(u, coarse, i, j, k) <= limit))
              asked[n] |= static_cast<std::uint8_t>(1 << ((i >> 2) << 2 | (j >> 2) << 1 | k >> 2));
    }
  });
  std::vector<LeafCoordinates> octants;
  for (std::size_t n = 0; n < count; ++n)
    for (int octant = 0; octant < 8; ++octant)
      if (asked[n] >> octant & 1) {
        const LeafCoordinates& leaf = at.leaves[first + n];
        octants.push_back(
            moved({2 * leaf[0], 2 * leaf[1], 2 * leaf[2]}, octant >> 2 & 1, octant >> 1 & 1, octant & 1));
      }
  return octants;
}

std::vector<LeafCoordinates> PyramidBuilder::octants_to_refine(std::size_t level) {
  std::vector<LeafCoordinates> octants = octants_in_question(level);
  levels_[level].tested = levels_[level].leaves.size();
  if (level + 1 < levels_.size())
    std::erase_if(
        octants, [&](const LeafCoordinates& leaf) { return levels_[level + 1].table.find(leaf) != no_leaf; });
  const Lattice& coarse = levels_[level].lattice;
  const Lattice fine{coarse.origin, coarse.voxel_size / 2};
  std::vector<double> error(octants.size());
  for (std::size_t first = 0; first < octants.size(); first += points_per_call / tested_nodes) {
    const std::size_t count = std::min(points_per_call / tested_nodes, octants.size() - first);
    progress_.check();
    Points x(3, static_cast<Eigen::Index>(count * tested_nodes));
    for (std::size_t n = 0; n < count; ++n)
      for (int number = 0; number < tested_nodes; ++number) {
        const std::array<int, 3> node = tested_node(number);
        for (int axis = 0; axis < 3; ++axis)
          x(axis, static_cast<Eigen::Index>(n * tested_nodes) + number) =
              fine.origin[axis] + fine.voxel_size * (leaf_edge * octants[first + n][axis] + node[axis]);
      }
    const Points u = map_.displacement(x);
    parallel_for(count, 16, [&](std::size_t begin, std::size_t end) {
      NodeBlock sum, refined;
      for (std::size_t n = begin; n < end; ++n) {
        const LeafCoordinates& octant = octants[first + n];
        sum_block(level, parent_of(octant), sum);
        refine_block(sum, octant_number(octant), refined);
        const std::bitset<8> missing = missing_blocks(level, parent_of(octant));
        for (int number = 0; number < tested_nodes; ++number) {
          if (missing.any() && touches(missing, cell_of_octant(octant, number))) continue;
          const Vector3 exact = u.col(static_cast<Eigen::Index>(n * tested_nodes) + number);
          error[first + n] = std::max(
              error[first + n], (exact - value_at(refined, tested_node(number))).norm() + rounding_at(exact));
        }
      }
    });
    evaluated_points_ += count * tested_nodes;
  }
  std::vector<LeafCoordinates> refined;
  for (std::size_t n = 0; n < octants.size(); ++n)
    if (!(error[n] <= test_margin * options_.tolerance)) refined.push_back(octants[n]);
  return refined;
}

// What storing u may cost where no finer leaf makes up for it, beyond the quantum, which the margin covers.
double PyramidBuilder::rounding_at(const Vector3& u) const {
  if (options_.precision == ValuePrecision::single) return 0;
  constexpr double half_of_last_bit = 0x1p-12;
  return half_of_last_bit * u.norm();
}

// Around a leaf, numbered as octants. Outside the band u is zero, so nothing is missing at the coarsest
// level.
std::bitset<8> PyramidBuilder::missing_blocks(std::size_t level, const LeafCoordinates& leaf) const {
  std::bitset<8> missing;
  if (level == 0) return missing;
  for (int octant = 1; octant < 8; ++octant)
    missing[static_cast<std::size_t>(octant)] =
        levels_[level].table.find(moved(leaf, octant >> 2 & 1, octant >> 1 & 1, octant & 1)) == no_leaf;
  return missing;
}

// Leaves that are missing beside a leaf whose residual is too large on that side.
std::vector<LeafCoordinates> PyramidBuilder::rim_neighbours(std::size_t level) const {
  const Level& at = levels_[level];
  const double limit = std::min(options_.tolerance, rim_gradient * at.lattice.voxel_size);
  std::vector<std::vector<LeafCoordinates>> found(at.leaves.size());
  parallel_for(at.leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
    NodeBlock coarse;
    for (std::size_t n = begin; n < end; ++n) {
      bool known = false;
      for (int side = 0; side < 27; ++side) {
        const std::array<int, 3> step = {side / 9 - 1, side / 3 % 3 - 1, side % 3 - 1};
        const LeafCoordinates neighbour = moved(at.leaves[n], step[0], step[1], step[2]);
        if (at.table.find(neighbour) != no_leaf) continue;
        if (!known) coarse_block(level, at.leaves[n], coarse);
        known = true;
        const auto from = [&](int axis) { return step[axis] > 0 ? leaf_edge - 1 : 0; };
        const auto to = [&](int axis) { return step[axis] < 0 ? 0 : leaf_edge - 1; };
        double largest = 0;
        for (int i = from(0); i <= to(0); ++i)
          for (int j = from(1); j <= to(1); ++j)
            for (int k = from(2); k <= to(2); ++k)
              largest = std::max(largest, squared_residual(at.samples[n], coarse, i, j, k));
        if (!(largest <= limit * limit)) found[n].push_back(neighbour);
      }
    }
  });
  std::vector<LeafCoordinates> neighbours;
  for (const auto& part : found) neighbours.insert(neighbours.end(), part.begin(), part.end());
  sort_unique(neighbours);
  return neighbours;
}

void PyramidBuilder::close_rims() {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    if (levels_[level].rims_known) continue;
    levels_[level].rims_known = true;
    const std::vector<LeafCoordinates> neighbours = rim_neighbours(level);
    if (neighbours.empty()) continue;
    add(level, neighbours);
    level = 0;  // what was added may change the rims of every level
  }
}

void PyramidBuilder::refine() {
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    if (levels_[level].tested == levels_[level].leaves.size()) continue;
    progress_.check();
    if (is_finest(level)) {
      levels_[level].tested = levels_[level].leaves.size();
      continue;
    }
    const std::vector<LeafCoordinates> octants = octants_to_refine(level);
    if (!octants.empty()) add(level + 1, octants);
    close_rims();
    level = static_cast<std::size_t>(-1);  // rims may have added leaves at any level
  }
}

std::size_t PyramidBuilder::refine_at(const Points& x) {
  std::vector<std::vector<LeafCoordinates>> wanted(levels_.size() + 1);
  for (Eigen::Index i = 0; i < x.cols(); ++i) want_leaf_at(x.col(i), wanted);
  const std::size_t before = leaf_count();
  for (std::size_t level = 1; level < wanted.size(); ++level)
    if (!wanted[level].empty()) add(level, wanted[level]);
  close_rims();
  return leaf_count() - before;
}

// In a cell at a rim the leaves beyond the rim, elsewhere a finer one.
void PyramidBuilder::want_leaf_at(const Vector3& x, std::vector<std::vector<LeafCoordinates>>& wanted) const {
  for (std::size_t level = levels_.size(); level-- > 0;) {
    const Lattice& lattice = levels_[level].lattice;
    const Eigen::Vector3i cell = ((x - lattice.origin) / lattice.voxel_size).array().floor().cast<int>();
    const LeafCoordinates leaf = {cell.x() >> 3, cell.y() >> 3, cell.z() >> 3};
    if (levels_[level].table.find(leaf) == no_leaf) continue;
    const std::array<int, 3> in_leaf = {cell.x() & 7, cell.y() & 7, cell.z() & 7};
    const std::bitset<8> missing = missing_blocks(level, leaf);
    for (int block = 1; block < 8; ++block)
      if (missing[static_cast<std::size_t>(block)] && reaches_block(in_leaf, block))
        wanted[level].push_back(moved(leaf, block >> 2 & 1, block >> 1 & 1, block & 1));
    if (!touches(missing, in_leaf) && !is_finest(level))
      wanted[level + 1].push_back({cell.x() >> 2, cell.y() >> 2, cell.z() >> 2});
    return;
  }
}

// Fills stored.values with the rounded residuals of the level's leaves, taken in `order`, and replaces the
// samples by what is stored so far at their nodes.
void PyramidBuilder::round_level(PyramidLevel& stored, std::size_t level,
                                 const std::vector<std::size_t>& order) {
  Level& at = levels_[level];
  const bool is_last = level + 1 == levels_.size();
  const auto sums = std::make_shared<std::vector<float>>(is_last ? 0 : 3 * leaf_nodes * order.size());
  parallel_for(order.size(), 16, [&](std::size_t begin, std::size_t end) {
    NodeBlock coarse;
    for (std::size_t n = begin; n < end; ++n) {
      coarse_block(level, stored.leaves[n], coarse);
      const float* u = at.samples[order[n]];
      const std::span<float> values(&stored.values[3 * leaf_nodes * n], 3 * leaf_nodes);
      const auto coarse_value = [&](int node, int c) {
        return coarse[c][(node / 64 * block_edge + node / 8 % 8) * block_edge + node % 8];
      };
      for (int node = 0; node < leaf_nodes; ++node)
        for (int c = 0; c < 3; ++c)
          values[3 * node + c] = static_cast<float>(u[3 * node + c] - coarse_value(node, c));
      round_values(values, options_.tolerance, options_.precision);
      if (is_last) continue;
      for (int node = 0; node < leaf_nodes; ++node)
        for (int c = 0; c < 3; ++c)
          (*sums)[3 * (leaf_nodes * n + node) + c] =
              static_cast<float>(coarse_value(node, c) + values[3 * node + c]);
    }
  });
  if (is_last) return;
  for (std::size_t n = 0; n < order.size(); ++n) at.samples[order[n]] = sums->data() + 3 * leaf_nodes * n;
  at.batches = {sums};
}

Pyramid PyramidBuilder::pyramid() const {
  PyramidBuilder stored(*this);
  Pyramid result;
  result.origin = coarsest_.origin;
  result.precision = options_.precision;
  result.levels.resize(levels_.size());
  for (std::size_t level = 0; level < levels_.size(); ++level) {
    const std::vector<LeafCoordinates>& leaves = levels_[level].leaves;
    std::vector<std::size_t> order(leaves.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return leaves[a] < leaves[b]; });
    PyramidLevel& to = result.levels[level];
    to.voxel_size = levels_[level].lattice.voxel_size;
    to.values.resize(3 * leaf_nodes * leaves.size());
    for (const std::size_t n : order) to.leaves.push_back(leaves[n]);
    stored.round_level(to, level, order);
  }
  LeafTable finer;
  for (std::size_t level = levels_.size(); level-- > 0;) {
    PyramidLevel& to = result.levels[level];
    const auto has_child = [&](const LeafCoordinates& leaf) {
      for (int octant = 0; octant < 8; ++octant)
        if (finer.find(moved({2 * leaf[0], 2 * leaf[1], 2 * leaf[2]}, octant >> 2 & 1, octant >> 1 & 1,
                             octant & 1)) != no_leaf)
          return true;
      return false;
    };
    keep_leaves(to, [&](const LeafCoordinates& leaf, bool zero) { return !zero || has_child(leaf); });
    finer = LeafTable(to.leaves);
  }
  while (!result.levels.empty() && result.levels.back().leaves.empty()) result.levels.pop_back();
  return result;
}

}  // namespace bespoke
