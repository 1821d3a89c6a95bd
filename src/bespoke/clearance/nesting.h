#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// The order of products (numbers of the list) from the inside to the outside, by how they lie on the source:
/// one lies over another where most of what of them is within 2.5 % of `source_diagonal` (mesh units) of the
/// other's faces is on that side. Products that do not lie over each other keep the order of the list.
std::vector<std::size_t> nesting_order(const std::vector<TriangleMesh>& products, double source_diagonal);

}  // namespace bespoke
