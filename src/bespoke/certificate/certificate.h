#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/lattice/pyramid.h"
#include "bespoke/progress.h"

namespace bespoke {

/// A finest cell in which det ∇ is not positive everywhere.
struct FoldedCell {
  int level = 0;
  Vector3 center;          ///< mesh units, source frame
  double determinant = 0;  ///< a value ≤ 0 that det takes in the cell, no unit
};

/// What is proved about x ↦ (1−t) x + t E(x) (and so about Ψ(t), which differs by a rigid motion).
struct Certificate {
  std::size_t certified = 0;       ///< finest cells with det > 0 proved
  std::size_t undecided = 0;       ///< cells that the subdivision limit left open
  std::size_t folded = 0;          ///< cells with a point of det ≤ 0
  double min_determinant = 0;      ///< lower bound over certified cells and the affine part, no unit
  double affine_determinant = 0;   ///< det of the affine part
  std::vector<FoldedCell> places;  ///< of folded and undecided cells, at most 1000, in lattice order
  double seconds = 0;

  /// All cells certified and det A > 0: then the map is a homeomorphism of all of space, because it is
  /// continuous, piecewise trilinear with det ≥ ε and affine outside a bounded set (src/bespoke/README.md,
  /// "Certificate").
  bool is_bijection() const { return undecided == 0 && folded == 0 && affine_determinant > 0; }
};

/// One line.
std::string to_string(const Certificate& certificate);

/// Bounds det ∇ of every finest cell by its 27 Bézier coefficients, subdividing where they disagree in sign
/// (Johnen, Weill, Remacle 2017), on the float values as stored, with the rounding error of the bound itself
/// deducted.
Certificate certify(const Pyramid& pyramid, const AffineMap& affine, double t = 1,
                    const Progress& progress = {});

/// The same with every place, not only the first 1000.
Certificate certify_listing_all(const Pyramid& pyramid, const AffineMap& affine, double t = 1,
                                const Progress& progress = {});

/// Leaves the first 1000 places.
void keep_first_places(Certificate& certificate);

}  // namespace bespoke
