#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "bespoke/types.h"

namespace bespoke {

/// How points move, at several times at once, so that many times cost one look-up. Both functions are called
/// from several threads at a time, for blocks of points in no particular order; what they return for a point
/// must not depend on its block.
struct PointMotion {
  std::size_t frames = 1;  ///< times

  /// Where the columns of x (3×n, mesh units) go: one 3×n matrix a frame.
  std::function<std::vector<Points>(const Points& x)> images;

  /// The same at points that are none of the product's, which a caller may want to count apart; empty where
  /// `images` does for them too.
  std::function<std::vector<Points>(const Points& x)> images_elsewhere;
  std::vector<Points> at_other_points(const Points& x) const {
    return images_elsewhere ? images_elsewhere(x) : images(x);
  }

  /// The motion's Jacobians at the columns of x: one 3×3n matrix a frame, three columns a point, entry (i, j)
  /// the derivative of coordinate i by x_j.
  std::function<std::vector<Points>(const Points& x)> jacobians;

  /// Called once all points have moved and before any file is replaced; what it throws leaves all as it was.
  std::function<void()> accept = [] {};
};

}  // namespace bespoke
