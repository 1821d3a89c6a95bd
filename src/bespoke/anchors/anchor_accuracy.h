#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/anchors/swapped_anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A pair that lies much farther beside the target than the others do.
struct OutlierAnchor {
  std::size_t index = 0;
  double distance = 0;  ///< mesh units
};

/// A pair that strains the surfaces, and that surfaces registered without it displace.
struct RejectedAnchor {
  std::size_t index = 0;
  double distance = 0;  ///< of its target from where they put it, mesh units
};

/// An exact pair that is not met, since meeting it would stretch the surface too much.
struct GivenWayAnchor {
  std::size_t index = 0;
  double sigma = 0;  ///< accuracy that it was given instead, mesh units
};

/// What the models say about anchors that came without a weight and without a σ.
struct AnchorAccuracy {
  std::size_t estimated = 0;  ///< pairs whose σ was estimated
  double sigma = 0;           ///< of these, mesh units; 0: exact
  std::vector<OutlierAnchor> outliers;
  std::vector<SwappedAnchors> swapped;
  std::vector<RejectedAnchor> left_out;
  std::vector<GivenWayAnchor> given_way;

  /// Whether some pairs were not taken as they were given.
  bool doubts_any() const {
    return !(outliers.empty() && swapped.empty() && left_out.empty() && given_way.empty());
  }
};

/// Anchors as the fit uses them.
struct EstimatedAnchors {
  Anchors anchors;                ///< without pairs left out; every pair without a weight has its σ
  std::vector<std::size_t> kept;  ///< of the pairs given, ascending: those that `anchors` has
  std::vector<double> sigmas;  ///< of all pairs given, mesh units; a swapped one's is the way to the other's
                               ///< target, of one that is left out the distance
  AnchorAccuracy accuracy;
};

/// Of the source's diagonal, as large as the target is: a σ below it is within the noise of remeshing.
inline constexpr double anchor_resolution = 1e-3;

/// Of the source's diagonal: anchors within it belong to the surface, farther ones are points of space.
inline constexpr double near_surface = 0.02;

/// Estimates σ of the pairs near the source's surface, mesh units: the root mean square of how far a fit
/// freed of the anchors moves their sources from their targets, at least, without those beyond 3 σ. Points of
/// space are exact, and all pairs where σ is below 0.1 % of the diagonal (tessellation). A pair left out has
/// its own distance as σ; beyond four times the others' it is an outlier. Swapped pairs (swapped_anchors.h)
/// without a given accuracy are dropped. Throws InvalidInput for unusable meshes.
EstimatedAnchors estimate_anchor_sigmas(const Anchors& anchors, const TriangleMesh& source,
                                        const TriangleMesh& target);

/// The same without these pairs too, which `accuracy` then lists as left out alone.
EstimatedAnchors without(EstimatedAnchors estimated, const std::vector<RejectedAnchor>& left_out);

/// One line, empty unless σ was estimated at more than 8 % of the target's diagonal: points at random in its
/// bounding box would lie no farther off. No fit follows from such anchors.
std::string off_target(const AnchorAccuracy& accuracy, const TriangleMesh& target);

/// One line, empty where nothing was estimated above 0 and nothing found.
std::string to_string(const AnchorAccuracy& accuracy, const Anchors& anchors);

}  // namespace bespoke
