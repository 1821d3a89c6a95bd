#include "bespoke/lattice/brick_atlas.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/pyramid_index.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int octant_nodes_edge = BrickAtlas::octant_edge + 1;
constexpr std::size_t octant_floats = 3 * octant_nodes_edge * octant_nodes_edge * octant_nodes_edge;
constexpr std::size_t whole_floats = 3 * block_nodes;

// From so many octants on, one brick of the whole leaf takes fewer bytes than theirs.
constexpr int octants_of_a_whole = static_cast<int>((whole_floats + octant_floats - 1) / octant_floats);

// Of the values' bytes: what the grid of the table may take, and what it may always take. A finer grid saves
// steps of the descent and takes space in the cache.
constexpr double grid_share = 1.0 / 32;
constexpr double min_grid_bytes = 1 << 14;

constexpr double largest_place = 1 << 30;

// Numbers of octants' bricks that are not an entry's.
constexpr std::uint32_t unread_brick = 1;  // of NaN, where a part was read; 0 is that of zeros

// The bricks of an entry.
struct EntryBricks {
  int octants = 0;          // bit o: octant o has a brick, or a part in the whole one
  std::uint32_t first = 0;  // number of the first brick among those of its kind
  bool is_read = true;      // all values that the bricks require are there
  bool whole() const { return std::popcount(static_cast<unsigned>(octants)) >= octants_of_a_whole; }
};

// Octants of an entry in which its level is not zero: those that one of the leaves reaches.
int touched_octants(const PyramidEntry& entry) {
  int touched = 0;
  for (int octant = 0; octant < 8; ++octant)
    for (int leaf = 0; leaf < 8; ++leaf)
      if (entry.blocks[leaf] != absent_leaf() &&
          cell_reaches(moved(first_place_of_octant(octant), {3, 3, 3}), leaf))
        touched |= 1 << octant;
  return touched;
}

// Those of them that deeper levels do not take over altogether.
int wanted_octants(const PyramidIndex& index, std::size_t level, const PyramidEntry& entry) {
  constexpr int all = 255;
  int wanted = touched_octants(entry);
  for (int octant = 0; octant < 8; ++octant) {
    const std::int32_t child = entry.children[octant];
    if (child != no_leaf && touched_octants(index.levels[level + 1][static_cast<std::size_t>(child)]) == all)
      wanted &= ~(1 << octant);
  }
  return wanted;
}

bool has_values(const PyramidEntry& entry) {
  return std::find(entry.blocks.begin(), entry.blocks.end(), unread_leaf()) == entry.blocks.end();
}

// Numbers of bricks, and what they take.
struct BrickCounts {
  std::size_t octants = 1;  // the first is of zeros
  std::size_t wholes = 0;

  // One more than the nodes take: the last node is read as four floats.
  std::size_t floats() const { return octants * octant_floats + wholes * whole_floats + 1; }
};

// Which bricks there are: `all` of the whole pyramid, of which `made` have their values.
struct Plan {
  Plan(const PyramidIndex& index, bool part) : bricks(index.levels.size()), is_part(part) {
    if (is_part) made.octants = unread_brick + 1;
    std::vector<bool> is_above_read(index.levels.front().size(), true);
    for (std::size_t level = 0; level < bricks.size(); ++level) {
      std::vector<bool> is_read(level + 1 < bricks.size() ? index.levels[level + 1].size() : 0);
      for (std::size_t number = 0; number < index.levels[level].size(); ++number) {
        const PyramidEntry& entry = index.levels[level][number];
        const bool read = is_above_read[number] && (!is_part || has_values(entry));
        add(level, wanted_octants(index, level, entry), read);
        for (const std::int32_t child : entry.children)
          if (child != no_leaf) is_read[static_cast<std::size_t>(child)] = read;
      }
      is_above_read = std::move(is_read);
    }
  }

  void add(std::size_t level, int wanted, bool is_read) {
    EntryBricks added{wanted, unread_brick, is_read};
    const std::size_t count =
        added.whole() ? 1 : static_cast<std::size_t>(std::popcount(static_cast<unsigned>(wanted)));
    (added.whole() ? all.wholes : all.octants) += count;
    if (is_read) {
      std::size_t& next = added.whole() ? made.wholes : made.octants;
      added.first = static_cast<std::uint32_t>(next);
      next += count;
    }
    bricks[level].push_back(added);
  }

  std::vector<std::vector<EntryBricks>> bricks;  // by level and entry
  bool is_part;
  BrickCounts all, made;
};

// Places of the leaves of level 0, all within reach of an int.
bool has_small_places(const PyramidIndex& index) {
  const double places = std::ldexp(2.0, static_cast<int>(index.levels.size()) - 1);
  for (const PyramidEntry& entry : index.levels.front())
    for (const int coordinate : entry.leaf)
      if (!(places * (std::abs(static_cast<double>(coordinate)) + 1) < largest_place)) return false;
  return true;
}

class AtlasMaker {
 public:
  // `value_bytes`: of the values of the whole pyramid.
  AtlasMaker(const Pyramid& pyramid, const PyramidIndex& index, bool is_part, std::size_t value_bytes)
      : index_(index), plan_(index, is_part), deepest_(static_cast<int>(index.levels.size()) - 1) {
    atlas_.origin = pyramid.origin;
    atlas_.places_per_unit =
        std::ldexp(1.0 / BrickAtlas::octant_edge, deepest_) / pyramid.levels[0].voxel_size;
    for (int level = 0; level <= deepest_; ++level) set_shapes(level, pyramid.lattice(level).voxel_size);
    fill_table(value_bytes);
  }

  bool is_small(double bytes) const {
    return plan_.all.octants <= std::size_t{1} << BrickAtlas::number_bits &&
           static_cast<double>(sizeof(float) * plan_.all.floats() + atlas_.table.byte_count()) <= bytes;
  }

  BrickAtlas make() && {
    // Not cleared first: the threads that write the values also fetch the pages.
    atlas_.value_count = plan_.made.floats();
    atlas_.values = std::make_unique_for_overwrite<float[]>(atlas_.value_count);
    std::fill_n(atlas_.values.get(), octant_floats, 0.0f);
    if (plan_.is_part)
      std::fill_n(atlas_.values.get() + unread_brick * octant_floats, octant_floats, unread_leaf()[0]);
    atlas_.values[atlas_.value_count - 1] = 0;
    parallel_for(index_.levels.front().size(), 1, [&](std::size_t begin, std::size_t end) {
      std::vector<NodeBlock> sums(index_.levels.size());
      for (std::size_t root = begin; root < end; ++root) {
        for (auto& component : sums[0]) component.fill(0);
        write_values(0, root, sums);
      }
    });
    return std::move(atlas_);
  }

 private:
  void set_shapes(int level, double voxel_size) {
    const int finer = deepest_ - level;
    BrickShape shape;
    shape.cells_per_place = std::ldexp(BrickAtlas::octant_edge, -finer);
    shape.inverse_voxel_size = 1 / voxel_size;
    shape.corner_mask = -(1 << finer);
    shape.last_cell = BrickAtlas::octant_edge - 1;
    shape.stride_y = 3 * octant_nodes_edge;
    shape.stride_x = octant_nodes_edge * shape.stride_y;
    shape.floats = octant_floats;
    atlas_.shapes[static_cast<std::size_t>(2 * level)] = shape;
    shape.corner_mask *= 2;
    shape.last_cell = leaf_edge - 1;
    shape.stride_y = 3 * block_edge;
    shape.stride_x = block_edge * shape.stride_y;
    shape.first = plan_.made.octants * octant_floats;
    shape.floats = whole_floats;
    atlas_.shapes[static_cast<std::size_t>(2 * level + 1)] = shape;
  }

  void fill_table(std::size_t value_bytes) {
    LatticeCoordinates low = index_.levels[0].front().leaf, high = low;
    for (const PyramidEntry& entry : index_.levels[0])
      for (int axis = 0; axis < 3; ++axis) {
        low[axis] = std::min(low[axis], entry.leaf[axis]);
        high[axis] = std::max(high[axis], entry.leaf[axis]);
      }
    const int leaf_places = 2 << deepest_;
    for (int axis = 0; axis < 3; ++axis) {
      low[axis] *= leaf_places;
      high[axis] = (high[axis] + 1) * leaf_places;
    }
    const double grid_bytes = std::max(min_grid_bytes, grid_share * static_cast<double>(value_bytes));
    atlas_.table =
        BrickTable(low, high, static_cast<std::size_t>(grid_bytes / sizeof(BrickTable::Reference)));
    std::copy_n(atlas_.table.low().begin(), 3, atlas_.low.begin());
    std::copy_n(atlas_.table.high().begin(), 3, atlas_.high.begin());
    for (std::size_t level = 0; level < index_.levels.size(); ++level)
      for (std::size_t entry = 0; entry < index_.levels[level].size(); ++entry) enter(level, entry);
  }

  void enter(std::size_t level, std::size_t entry) {
    const EntryBricks& bricks = plan_.bricks[level][entry];
    const bool is_whole = bricks.is_read && bricks.whole();
    const std::size_t shape = 2 * level + (is_whole ? 1 : 0);
    auto reference = static_cast<BrickTable::Reference>(shape << BrickAtlas::number_bits | bricks.first);
    for (int octant = 0; octant < 8; ++octant) {
      if (!(bricks.octants >> octant & 1)) continue;
      atlas_.table.set(child_of(index_.levels[level][entry].leaf, octant), deepest_ - static_cast<int>(level),
                       reference);
      if (bricks.is_read && !is_whole) ++reference;
    }
  }

  // Of an entry and of all below it; sums[level] holds the sum of the coarser levels.
  void write_values(std::size_t level, std::size_t number, std::vector<NodeBlock>& sums) {
    const PyramidEntry& entry = index_.levels[level][number];
    const EntryBricks& bricks = plan_.bricks[level][number];
    if (!bricks.is_read) return;
    add_leaves(entry, sums[level]);
    copy_bricks(level, bricks, sums[level]);
    for (int octant = 0; octant < 8; ++octant) {
      const std::int32_t child = entry.children[octant];
      if (child == no_leaf) continue;
      refine_block(sums[level], octant, sums[level + 1]);
      write_values(level + 1, static_cast<std::size_t>(child), sums);
    }
  }

  void copy_bricks(std::size_t level, const EntryBricks& bricks, const NodeBlock& sum) {
    const BrickShape& shape = atlas_.shapes[2 * level + (bricks.whole() ? 1 : 0)];
    float* to = atlas_.values.get() + shape.first + bricks.first * shape.floats;
    if (bricks.whole()) return copy_box(sum, {0, 0, 0}, block_edge, to);
    for (int octant = 0; octant < 8; ++octant) {
      if (!(bricks.octants >> octant & 1)) continue;
      copy_box(sum, first_place_of_octant(octant), octant_nodes_edge, to);
      to += shape.floats;
    }
  }

  static void copy_box(const NodeBlock& sum, const LatticeCoordinates& first, int edge, float* to) {
    for (int i = 0; i < edge; ++i)
      for (int j = 0; j < edge; ++j) {
        const int from = number_in_block(moved(first, {i, j, 0}));
        for (int k = 0; k < edge; ++k, to += 3)
          for (int c = 0; c < 3; ++c) to[c] = static_cast<float>(sum[c][from + k]);
      }
  }

  const PyramidIndex& index_;
  Plan plan_;
  int deepest_;
  BrickAtlas atlas_;
};

// `pyramid`: the levels that were read, of `leaves` leaves in the whole.
std::optional<BrickAtlas> made_of(const Pyramid& pyramid, const PyramidIndex& index, bool is_part,
                                  std::size_t leaves, double largest_share) {
  if (!(largest_sum(pyramid) <= std::numeric_limits<float>::max())) return std::nullopt;
  if (!has_small_places(index)) return std::nullopt;
  const std::size_t value_bytes = sizeof(float) * leaf_floats * leaves;
  AtlasMaker maker(pyramid, index, is_part, value_bytes);
  if (!maker.is_small(largest_share * static_cast<double>(value_bytes))) return std::nullopt;
  return std::move(maker).make();
}

bool has_levels(const Pyramid& pyramid) {
  return !pyramid.levels.empty() && pyramid.levels.size() <= BrickAtlas::max_levels;
}

}  // namespace

std::optional<BrickAtlas> make_brick_atlas(const Pyramid& pyramid, double largest_share) {
  if (!has_levels(pyramid)) return std::nullopt;
  return made_of(pyramid, PyramidIndex(pyramid), /*is_part=*/false, pyramid.leaf_count(), largest_share);
}

std::optional<BrickAtlas> make_brick_atlas(const PyramidPart& part, const PyramidIndex& index,
                                           double largest_share) {
  if (!has_levels(part.read)) return std::nullopt;
  return made_of(part.read, index, /*is_part=*/true, part.leaf_count(), largest_share);
}

}  // namespace bespoke
