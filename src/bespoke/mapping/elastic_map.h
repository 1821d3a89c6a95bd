#pragma once

#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// Closed balls of one radius.
struct BallCloud {
  Points centers;     ///< 3×n, mesh units
  double radius = 0;  ///< mesh units
};

/// Where u may be nonzero: x lies in the support when `frame * x` lies in one of the balls.
struct Support {
  AffineMap frame;
  std::vector<BallCloud> clouds;
};

/// E(x) = a₀ + A x + u(x): the source's space, in the source frame, onto the target's space in the source
/// frame (src/bespoke/README.md, "The mapping"). u is continuous and exactly zero outside the support.
/// Everything downstream knows a map only through this interface; exact maps and baked ones both implement
/// it. All members are thread-safe, run in parallel inside, and return the same bits at any thread count.
class ElasticMap {
 public:
  virtual ~ElasticMap() = default;

  virtual AffineMap affine() const = 0;

  /// u at the columns of x (3×n, mesh units), 3×n. Coherent order (neighbours in x near each other) is
  /// faster.
  virtual Points displacement(const Points& x) const = 0;

  /// ∇u at the columns of x: 3×3n, three columns per point, entry (i, j) = ∂uᵢ/∂xⱼ, no unit.
  virtual Points displacement_gradient(const Points& x) const = 0;

  virtual Support support() const = 0;

  /// E at the columns of x, 3×n.
  Points operator()(const Points& x) const { return affine() * x + displacement(x); }
};

}  // namespace bespoke
