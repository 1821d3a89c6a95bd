#pragma once

#include <vector>

namespace bespoke {

/// Disjoint sets of the numbers 0 … count − 1, at first one each (union-find with path halving).
class DisjointSets {
 public:
  explicit DisjointSets(int count);

  /// The least number of the set that i belongs to.
  int least(int i);

  /// Makes one set of those of a and b; false when they were one already.
  bool join(int a, int b);

 private:
  std::vector<int> parent_;
};

}  // namespace bespoke
