#include "bespoke/lattice/pyramid_index.h"

#include <utility>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::array<float, leaf_floats> zeros{};

std::vector<LeafCoordinates> with_lower_neighbours(const std::vector<LeafCoordinates>& leaves) {
  std::vector<LeafCoordinates> entries;
  entries.reserve(8 * leaves.size());
  for (const LeafCoordinates& leaf : leaves) {
    const LeafCoordinates lowest = moved(leaf, {-1, -1, -1});
    for (int block = 0; block < 8; ++block) entries.push_back(moved(lowest, corner_step(block)));
  }
  return unique_leaves(std::move(entries));
}

PyramidEntry make_entry(const LeafCoordinates& at, const PyramidLevel& level, const LeafTable& leaves,
                        const LeafTable& finer_entries) {
  PyramidEntry entry;
  entry.leaf = at;
  for (int n = 0; n < 8; ++n) {
    const int leaf = leaves.find(moved(at, corner_step(n)));
    entry.blocks[n] = leaf == no_leaf ? absent_leaf() : level.values_of(static_cast<std::size_t>(leaf));
    entry.children[n] = finer_entries.find(child_of(at, n));
  }
  return entry;
}

}  // namespace

const float* absent_leaf() { return zeros.data(); }

PyramidIndex::PyramidIndex(const Pyramid& pyramid) : levels(pyramid.levels.size()) {
  LeafTable finer_entries;
  for (std::size_t level = pyramid.levels.size(); level-- > 0;) {
    const PyramidLevel& stored = pyramid.levels[level];
    const LeafTable leaves(stored.leaves);
    const std::vector<LeafCoordinates> coordinates = with_lower_neighbours(stored.leaves);
    std::vector<PyramidEntry>& entries = levels[level];
    entries.resize(coordinates.size());
    parallel_for(entries.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        entries[i] = make_entry(coordinates[i], stored, leaves, finer_entries);
    });
    finer_entries = LeafTable(coordinates);
  }
  roots = std::move(finer_entries);
}

}  // namespace bespoke
