#pragma once

#include <vector>

#include "bespoke/pattern/flat_pattern.h"

namespace bespoke {

/// Sets what the seams ease, by the seam file and by their numbers. Throws InvalidInput for a number that no
/// seam has, for a piece that none is called, and for a seam file's ease that no seam of that piece takes.
void set_eases(const Garment& garment, const std::vector<Piece>& pieces, const PatternOptions& options,
               std::vector<Seam>& seams);

/// Sets the places of the seams that get notches for the marks: of each the nearest one on a seam, unless the
/// garment or a seam is far from it. pieces: where the marks are.
void set_marks(const std::vector<Piece>& pieces, const std::vector<SurfaceMark>& marks,
               std::vector<PatternSeam>& seams);

}  // namespace bespoke
