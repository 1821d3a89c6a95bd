#include "bespoke/bake/pyramid/balanced_values.h"

#include <algorithm>

namespace bespoke {
namespace {

// From a node to the next along an axis, in floats.
constexpr std::array<int, 3> strides = {3 * leaf_edge * leaf_edge, 3 * leaf_edge, 3};

void subtract_share(const LeafSurroundings& u, std::size_t axis, LeafValues& values) {
  const float* at = u.leaf->data();
  const int stride = strides[axis], to_far_side = stride * (leaf_edge - 1);
  for (int node = 0; node < leaf_nodes; ++node) {
    const int place = place_of_number(node)[axis];
    const LeafValues* below = place > 0 ? u.leaf : u.beside[axis][0];
    const LeafValues* above = place + 1 < leaf_edge ? u.leaf : u.beside[axis][1];
    if (!below || !above) continue;
    const float* lower = below->data() + 3 * node + (place > 0 ? -stride : to_far_side);
    const float* upper = above->data() + 3 * node + (place + 1 < leaf_edge ? stride : -to_far_side);
    for (int c = 0; c < 3; ++c)
      values[static_cast<std::size_t>(3 * node + c)] -=
          share_of_difference * (lower[c] - 2 * at[3 * node + c] + upper[c]);
  }
}

}  // namespace

std::shared_ptr<const LeafValues> balanced_values(const LeafSurroundings& u) {
  auto values = std::make_shared<LeafValues>(*u.leaf);
  for (std::size_t axis = 0; axis < 3; ++axis) subtract_share(u, axis, *values);
  for (auto node = u.leaf->begin(); node != u.leaf->end(); node += 3)
    if (std::all_of(node, node + 3, [](float component) { return component == 0; }))
      std::fill_n(values->begin() + (node - u.leaf->begin()), 3, 0.0f);
  return values;
}

}  // namespace bespoke
