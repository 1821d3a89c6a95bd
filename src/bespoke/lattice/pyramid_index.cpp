#include "bespoke/lattice/pyramid_index.h"

#include <algorithm>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::array<float, 3 * leaf_nodes> zeros{};

LeafCoordinates octant_of(const LeafCoordinates& leaf, int octant) {
  return {leaf[0] + (octant >> 2 & 1), leaf[1] + (octant >> 1 & 1), leaf[2] + (octant & 1)};
}

std::vector<LeafCoordinates> with_lower_neighbours(const std::vector<LeafCoordinates>& leaves) {
  std::vector<LeafCoordinates> entries;
  entries.reserve(8 * leaves.size());
  for (const LeafCoordinates& leaf : leaves)
    for (int octant = 0; octant < 8; ++octant)
      entries.push_back(octant_of({leaf[0] - 1, leaf[1] - 1, leaf[2] - 1}, octant));
  std::sort(entries.begin(), entries.end());
  entries.erase(std::unique(entries.begin(), entries.end()), entries.end());
  return entries;
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
      for (std::size_t i = begin; i < end; ++i) {
        const LeafCoordinates& leaf = coordinates[i];
        entries[i].leaf = leaf;
        for (int octant = 0; octant < 8; ++octant) {
          const int block = leaves.find(octant_of(leaf, octant));
          entries[i].blocks[octant] =
              block == no_leaf ? absent_leaf() : &stored.values[std::size_t{3} * leaf_nodes * block];
          entries[i].children[octant] =
              finer_entries.find(octant_of({2 * leaf[0], 2 * leaf[1], 2 * leaf[2]}, octant));
        }
      }
    });
    finer_entries = LeafTable(coordinates);
  }
  roots = std::move(finer_entries);
}

}  // namespace bespoke
