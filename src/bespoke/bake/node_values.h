#pragma once

#include <array>

#include "bespoke/enum_names.h"

namespace bespoke {

/// What the sum of the levels of a nested pyramid is at their nodes.
enum class NodeValues {
  sampled,   ///< u at the node: between nodes, interpolation errs to one side
  balanced,  ///< so near u that interpolation errs as far to either side
             ///< (detail/balanced_values.h); of the finest voxels that a tolerance allows, u
};
inline constexpr std::array node_values{Named<NodeValues>{"sampled", NodeValues::sampled},
                                        Named<NodeValues>{"balanced", NodeValues::balanced}};

}  // namespace bespoke
