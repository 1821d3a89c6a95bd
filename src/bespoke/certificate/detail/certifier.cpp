#include "bespoke/certificate/detail/certifier.h"

#include <algorithm>
#include <cmath>

#include "bespoke/certificate/jacobian_bound.h"

namespace bespoke {
namespace {

constexpr double unit_roundoff = 0x1p-53;

// Of the sum of the levels at a node: each level rounds three times when it is interpolated and once when it
// is added.
double rounding_of_sum(const Pyramid& pyramid) {
  return 4 * static_cast<double>(pyramid.levels.size() + 1) * unit_roundoff * largest_sum(pyramid);
}

DeterminantRange range_of(const EntryCells& cells, int cell, const JacobianBlock& block,
                          const Matrix3& linear, double scale) {
  const double bound = block.lower_bound[static_cast<std::size_t>(cell)];
  if (bound > 0) return {CellVerdict::certified, bound, bound};
  return decide_cell(bezier_coefficients(*cells.sum, cell, linear, scale), block.margin);
}

}  // namespace

CellCounts combine(CellCounts a, const CellCounts& b) {
  a.certified += b.certified;
  a.undecided += b.undecided;
  a.folded += b.folded;
  a.least = std::min(a.least, b.least);
  a.places.insert(a.places.end(), b.places.begin(), b.places.end());
  return a;
}

Certifier::Certifier(const Pyramid& pyramid, const Matrix3& affine, double t)
    : pyramid_(pyramid),
      index_(pyramid),
      linear_((1 - t) * Matrix3::Identity() + t * affine),
      linear_error_(4 * unit_roundoff * (std::abs(1 - t) + std::abs(t) * affine.cwiseAbs().maxCoeff())),
      t_(t),
      sum_error_(rounding_of_sum(pyramid)) {}

CellCounts Certifier::certify_roots(std::size_t begin, std::size_t end) const {
  CellCounts counts;
  for (std::size_t root = begin; root < end; ++root)
    visit_finest_cells(index_, root, [&](const EntryCells& cells) { certify_entry(cells, counts); });
  return counts;
}

void Certifier::certify_entry(const EntryCells& cells, CellCounts& counts) const {
  const Lattice lattice = pyramid_.lattice(cells.level);
  const double scale = t_ / lattice.voxel_size;
  JacobianBlock block;
  bound_block(*cells.sum, linear_, scale, linear_error_ + std::abs(t_) / lattice.voxel_size * sum_error_,
              block);
  for (int cell = 0; cell < leaf_nodes; ++cell) {
    if (!cells.finest[static_cast<std::size_t>(cell)]) continue;
    const DeterminantRange range = range_of(cells, cell, block, linear_, scale);
    if (range.verdict == CellVerdict::certified) {
      ++counts.certified;
      counts.least = std::min(counts.least, range.lower_bound);
      continue;
    }
    ++(range.verdict == CellVerdict::folded ? counts.folded : counts.undecided);
    const LatticeCoordinates lower = moved(first_node(cells.leaf), place_of_number(cell));
    counts.places.push_back(
        {cells.level, lattice.at(as_vector(lower) + Vector3::Constant(0.5)), range.value});
  }
}

}  // namespace bespoke
