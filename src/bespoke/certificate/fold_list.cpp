#include "bespoke/certificate/fold_list.h"

#include <algorithm>
#include <utility>

#include "bespoke/certificate/detail/certifier.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// False when it is there already.
bool insert(LeafTable& table, const LeafCoordinates& leaf) {
  if (table.find(leaf) != no_leaf) return false;
  table.insert(leaf, 0);
  return true;
}

// Entries whose cells change with the values at some nodes.
class StaleEntries {
 public:
  explicit StaleEntries(const std::vector<std::vector<LatticeCoordinates>>& changed)
      : touched_(changed.size()), above_(changed.size()) {
    for (std::size_t level = 0; level < changed.size(); ++level)
      for (const LatticeCoordinates& node : changed[level]) add(level, node);
  }

  // A cell at a changed node, or below such a cell's entry: what lies below changes as well.
  bool holds(int level, LeafCoordinates entry) const {
    for (; level >= 0; --level, entry = parent_of(entry))
      if (touched_[static_cast<std::size_t>(level)].find(entry) != no_leaf) return true;
    return false;
  }

  // On the way down to stale entries.
  bool leads_to(int level, const LeafCoordinates& entry) const {
    return above_[static_cast<std::size_t>(level)].find(entry) != no_leaf || holds(level, entry);
  }

 private:
  void add(std::size_t level, const LatticeCoordinates& node) {
    for (int corner = 0; corner < 8; ++corner) {
      const LatticeCoordinates back = corner_step(corner);
      LeafCoordinates entry = leaf_of({node[0] - back[0], node[1] - back[1], node[2] - back[2]});
      if (!insert(touched_[level], entry)) continue;
      for (std::size_t up = level; up-- > 0;) {
        entry = parent_of(entry);
        if (!insert(above_[up], entry)) break;
      }
    }
  }

  std::vector<LeafTable> touched_, above_;  // by level
};

}  // namespace

struct FoldList::Cells {
  Cells(const Pyramid& pyramid_in, const AffineMap& affine)
      : pyramid(pyramid_in), certifier(pyramid_in, affine.linear, 1) {}

  CellCounts certify(const StaleEntries& stale, std::size_t root) const {
    CellCounts counts;
    visit_finest_cells(
        certifier.index(), root,
        [&](int level, const LeafCoordinates& leaf) { return stale.leads_to(level, leaf); },
        [&](const EntryCells& cells) {
          if (stale.holds(cells.level, cells.leaf)) certifier.certify_entry(cells, counts);
        });
    return counts;
  }

  const Pyramid& pyramid;
  Certifier certifier;
};

FoldList::FoldList(const Pyramid& pyramid, const AffineMap& affine, std::vector<FoldedCell> places)
    : cells_(std::make_unique<Cells>(pyramid, affine)), places_(std::move(places)) {}

FoldList::~FoldList() = default;

void FoldList::update(const std::vector<std::vector<LatticeCoordinates>>& changed) {
  const StaleEntries stale(changed);
  std::erase_if(places_, [&](const FoldedCell& cell) {
    return stale.holds(cell.level, leaf_of(cells_->pyramid.lattice(cell.level).cell_of(cell.center)));
  });
  const Certifier& certifier = cells_->certifier;
  std::vector<std::size_t> roots;
  for (std::size_t root = 0; root < certifier.roots(); ++root)
    if (stale.leads_to(0, certifier.index().levels.front()[root].leaf)) roots.push_back(root);
  const CellCounts found = parallel_reduce(
      roots.size(), 1, CellCounts{},
      [&](std::size_t begin, std::size_t) { return cells_->certify(stale, roots[begin]); }, combine);
  places_.insert(places_.end(), found.places.begin(), found.places.end());
}

}  // namespace bespoke
