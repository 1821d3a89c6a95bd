#include "bespoke/lattice/pyramid_index.h"

#include <limits>
#include <optional>
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

/// Where the values of a level's leaves stand.
class LeafValues {
 public:
  LeafValues(const PyramidLevel& read, const std::vector<LeafCoordinates>& all)
      : read_(read), read_table_(read.leaves) {
    if (read.leaves.size() < all.size()) whole_table_.emplace(all);
  }

  const float* operator()(const LeafCoordinates& leaf) const {
    if (const int found = read_table_.find(leaf); found != no_leaf)
      return read_.values_of(static_cast<std::size_t>(found));
    return whole_table_ && whole_table_->find(leaf) != no_leaf ? unread_leaf() : absent_leaf();
  }

 private:
  const PyramidLevel& read_;
  LeafTable read_table_;
  std::optional<LeafTable> whole_table_;  // where some leaves were not read
};

PyramidEntry make_entry(const LeafCoordinates& at, const LeafValues& values, const LeafTable& finer_entries) {
  PyramidEntry entry;
  entry.leaf = at;
  for (int n = 0; n < 8; ++n) {
    entry.blocks[n] = values(moved(at, corner_step(n)));
    entry.children[n] = finer_entries.find(child_of(at, n));
  }
  return entry;
}

}  // namespace

const float* absent_leaf() { return zeros.data(); }

const float* unread_leaf() {
  static const std::vector<float> values(leaf_floats, std::numeric_limits<float>::quiet_NaN());
  return values.data();
}

// From the finest level up: `roots` has the entries of the level below until the last is added.
PyramidIndex::PyramidIndex(const Pyramid& pyramid) : levels(pyramid.levels.size()) {
  for (std::size_t level = levels.size(); level-- > 0;)
    add_level(level, pyramid.levels[level], pyramid.levels[level].leaves);
}

PyramidIndex::PyramidIndex(const PyramidPart& part) : levels(part.leaves.size()) {
  for (std::size_t level = levels.size(); level-- > 0;)
    add_level(level, part.read.levels[level], part.leaves[level]);
}

void PyramidIndex::add_level(std::size_t level, const PyramidLevel& read,
                             const std::vector<LeafCoordinates>& all) {
  const LeafValues values(read, all);
  const std::vector<LeafCoordinates> coordinates = with_lower_neighbours(all);
  std::vector<PyramidEntry>& entries = levels[level];
  entries.resize(coordinates.size());
  parallel_for(entries.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) entries[i] = make_entry(coordinates[i], values, roots);
  });
  roots = LeafTable(coordinates);
}

}  // namespace bespoke
