#pragma once

#include <array>
#include <vector>

#include "bespoke/rbf/rbf_layer.h"

namespace bespoke {

/// A rigorous bound of ‖∇u(x)‖ over all x, not over samples only, for u(x) = Σ cⱼ φ(|x − zⱼ| / λ) with
/// Wendland's C2 function. Keeps what it found cell by cell, so that a layer changed in places is bounded
/// again in these places.
class GradientBound {
 public:
  /// How closely to look where the gradient exceeds `enough` for certain.
  enum class Closeness { rough, tight };

  /// Bounds the layer as it is. `changed`: one flag per centre, set where the coefficient is not that of the
  /// last call; empty for the first one. Looks as closely as it takes to show that ‖∇u‖ ≤ enough (> 0).
  void update(const RbfLayer& layer, double enough, Closeness closeness,
              const std::vector<char>& changed = {});

  /// ≥ ‖∇u(x)‖ for all x.
  double largest() const;

  /// A cube in which ‖∇u‖ may exceed `enough`.
  struct SteepPlace {
    Vector3 center;       ///< mesh units
    double radius = 0;    ///< of the ball around the cube, mesh units
    double estimate = 0;  ///< of the largest ‖∇u‖ in it, from samples
  };
  std::vector<SteepPlace> steep_places() const;

 private:
  using Cell = std::array<int, 3>;
  struct Found {
    double largest = 0;
    std::vector<SteepPlace> steep;
  };
  class Search;

  std::vector<Cell> cells_;
  std::vector<Found> found_;  // one for each cell
};

}  // namespace bespoke
