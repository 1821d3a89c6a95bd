#include "bespoke/mesh/disjoint_sets.h"

#include <algorithm>
#include <numeric>

namespace bespoke {

DisjointSets::DisjointSets(int count) : parent_(static_cast<std::size_t>(count)) {
  std::iota(parent_.begin(), parent_.end(), 0);
}

int DisjointSets::least(int i) {
  while (parent_[static_cast<std::size_t>(i)] != i) {
    int& parent = parent_[static_cast<std::size_t>(i)];
    parent = parent_[static_cast<std::size_t>(parent)];
    i = parent;
  }
  return i;
}

bool DisjointSets::join(int a, int b) {
  a = least(a);
  b = least(b);
  if (a == b) return false;
  parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
  return true;
}

}  // namespace bespoke
