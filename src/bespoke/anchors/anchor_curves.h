#pragma once

#include <span>
#include <vector>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// The place of a polyline, 3×n, at a share of its length, in [0, 1]; a closed one goes on from its last
/// point to its first.
Vector3 point_along(const Points& polyline, bool closed, double share);

/// The place of a polyline that is nearest to x.
Vector3 nearest_along(const Points& polyline, bool closed, const Vector3& x);

/// Largest distance of points, 3×k, from a polyline, mesh units.
double distance_from_polyline(const Points& polyline, bool closed, const Points& points);

/// Curves as pairs of points along them, behind the pairs that there are already.
class CurvePairs {
 public:
  /// Pairs lie at most `spacing` (> 0, mesh units) apart on the source, at equal shares of length between
  /// fixed points. A closed curve without fixed points begins, and runs, where and as the pairs, moved
  /// rigidly, put it. Where a pair, or an earlier curve, lies within half a spacing on the source (of a
  /// fixed point: at its place), that represents the place alone. Throws InvalidInput for a spacing that is
  /// not positive, and for such a closed curve with fewer than three pairs or collinear ones.
  CurvePairs(const Anchors& given, double spacing);

  /// All pairs; those of curves, except for fixed points, with this accuracy (≥ 0, mesh units).
  Anchors pairs(double sigma) const;

  /// Moves the counterparts along their curves to where they are nearest to these places (3×k, target frame)
  /// of the curves' points, among what lies within `reach` (mesh units along the curve) of where equal shares
  /// put them. Where they would pass one another, or come closer than a quarter of their even spacing, they
  /// go as near to that as their order allows, in the sense of least squares. Fixed points stay.
  void slide(const Points& places, double reach);

  /// Draws the counterparts back towards `places` (3×k, target frame), where the surface was before it was to
  /// meet the curves, as far as they require displacements that no surface follows without folds: a quarter
  /// of the distance between two points at most is the difference of theirs, and from none at `held` (3×m).
  void give_way(const Points& places, const Points& held);

  Points sources() const;  ///< 3×k: the curves' points on the source

 private:
  struct Sample {
    std::size_t curve = 0;
    AnchorPair pair;
    bool is_fixed = false;
    double share = 0;  // of b's length, by equal shares; goes on past the beginning of a closed curve
  };

  bool is_taken(const Vector3& source, std::size_t curve, double distance) const;
  void slide_along(std::span<Sample> samples, const Points& places, double reach) const;

  Anchors given_;  // without its curves
  std::vector<AnchorCurve> curves_;
  std::vector<Sample> samples_;
};

}  // namespace bespoke
