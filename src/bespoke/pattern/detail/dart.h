#pragma once

#include <array>
#include <vector>

#include "bespoke/pattern/piece.h"

namespace bespoke {

/// Vertices of a piece from its outline inwards, along edges: from where the outline strains most, 85 % of
/// the way to the vertex farthest from the outline. strain: m. Empty where the piece has no vertex inside.
std::vector<int> dart_path(const Piece& piece, const Eigen::VectorXd& strain);

}  // namespace bespoke
