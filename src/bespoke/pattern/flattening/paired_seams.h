#pragma once

#include <string>
#include <vector>

#include "bespoke/pattern/piece.h"

namespace bespoke {

/// The seams between the pieces, and of pieces with themselves (darts, tubes that were cut): edges of
/// outlines that join the same two vertices of the product, in runs that go on on both sides. In the order of
/// the first piece's outline. Throws InvalidInput, naming the product, where three outlines meet along an
/// edge.
std::vector<Seam> paired_seams(const std::vector<Piece>& pieces, const std::string& product = "the product");

/// Length of a side with the piece's vertices at `places` (d×n), in their unit.
double side_length(const SeamSide& side, const Eigen::MatrixXd& places);

}  // namespace bespoke
