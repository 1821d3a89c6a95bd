#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/certificate/certificate.h"
#include "bespoke/progress.h"

namespace bespoke {

struct RepairSummary {
  std::size_t cells = 0;      ///< that folded before
  std::size_t folded = 0;     ///< that fold or are undecided after
  double largest_change = 0;  ///< of u at a node, mesh units
};

/// Moves nodes of folded cells towards the mean of their neighbours, finest level first, then coarser ones
/// for folds that are wider than their cells, until every cell is certified or it gives up. Only values
/// change, no leaf is added; nodes far from a fold keep theirs; values keep the pyramid's precision. Folds of
/// the affine part cannot be repaired. It gives up on a level once several rounds repair next to nothing.
/// `folds`: all folded and undecided cells of the pyramid's certificate.
RepairSummary repair_folds(Pyramid& pyramid, const AffineMap& affine, const std::vector<FoldedCell>& folds,
                           const Progress& progress = {});

}  // namespace bespoke
