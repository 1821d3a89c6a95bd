#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// How products lie over each other, as numbers of their list.
struct Nesting {
  std::vector<std::size_t> order;  ///< from the inside to the outside
  /// Pairs, the smaller number first, that are near each other while neither lies over the other.
  std::vector<std::pair<std::size_t, std::size_t>> interleaved;
  /// Whether some lie over each other in a circle, so that no order is right.
  bool is_circular = false;
};

/// The order in which the products of a call are kept from each other.
struct LayerOrder {
  std::vector<std::string> names;  ///< from the inside to the outside
  bool is_found = false;           ///< on the source; else the call named them so
  std::vector<std::pair<std::string, std::string>> interleaved = {};  ///< and left as the call named them
  bool is_circular = false;
};

/// Of products on the source: one lies over another where nine tenths of the area of both that is above the
/// other, within 2.5 % of `source_diagonal` (mesh units), are its own. Those that do not lie over each other
/// keep the order of the list.
Nesting nesting_of(const std::vector<TriangleMesh>& products, double source_diagonal);

}  // namespace bespoke
