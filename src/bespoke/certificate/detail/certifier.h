#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "bespoke/certificate/certificate.h"
#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {

/// What is known about some of the finest cells.
struct CellCounts {
  std::size_t certified = 0;
  std::size_t undecided = 0;
  std::size_t folded = 0;
  double least = std::numeric_limits<double>::infinity();  ///< lower bound of det over certified cells
  std::vector<FoldedCell> places;                          ///< of folded and undecided cells
};

CellCounts combine(CellCounts a, const CellCounts& b);

/// Decides the sign of det ∇((1−t) x + t E) in finest cells. Refers to the pyramid, so that it sees changes
/// of its values. Thread-safe.
class Certifier {
 public:
  /// `affine`: linear part of E.
  Certifier(const Pyramid& pyramid, const Matrix3& affine, double t);

  const PyramidIndex& index() const { return index_; }
  std::size_t roots() const { return index_.levels.empty() ? 0 : index_.levels.front().size(); }

  /// All finest cells of these root entries.
  CellCounts certify_roots(std::size_t begin, std::size_t end) const;

  /// Adds the finest cells of one entry.
  void certify_entry(const EntryCells& cells, CellCounts& counts) const;

 private:
  const Pyramid& pyramid_;
  PyramidIndex index_;
  Matrix3 linear_;
  double linear_error_;
  double t_;
  double sum_error_;
};

}  // namespace bespoke
