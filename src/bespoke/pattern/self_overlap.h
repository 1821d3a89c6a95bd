#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

namespace bespoke {

/// Two edges of an outline, by the positions in it where they begin.
using OutlineCrossing = std::array<int, 2>;

/// The first edges of a closed outline that meet although they are no neighbours; none for a simple one. A
/// flat disk without flipped faces covers no place twice exactly if its outline is simple. places: 2×n,
/// outline: columns.
std::optional<OutlineCrossing> outline_crossing(const Eigen::Matrix2Xd& places,
                                                const std::vector<int>& outline);

}  // namespace bespoke
