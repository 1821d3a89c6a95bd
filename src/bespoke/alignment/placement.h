#pragma once

#include <vector>

#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// How well a source registered to a target explains it; to choose among placements of one source by.
/// Cavities (mesh/cavities.h) of either have zero weight in the distance.
struct PlacementFigures {
  double distance =
      0;  ///< mean of both surfaces' distances from the other, fraction of the target's diagonal
  double distortion = 0;  ///< root mean square deviation from local similarities over some patches, fraction
  double covered = 0;     ///< share of the target's area within 1 % of its diagonal of the source

  /// Lower is better: as in an alignment's misfit, a likelihood whose variances are not known. Surfaces that
  /// meet are equally near, whatever is left between their facets, so that of two right placements the one
  /// that distorts less is taken.
  double misfit() const { return (distance + distance_floor) * distortion; }

  /// Fraction of the target's diagonal.
  static constexpr double distance_floor = 1e-3;
};

/// Judges placements of one source on one target.
class PlacementScore {
 public:
  /// The meshes must outlive it. Throws InvalidInput for unusable meshes.
  PlacementScore(const TriangleMesh& source, const TriangleMesh& target);

  /// `placed`: 3×n, where the source's vertices lie on the target, mesh units. Throws InvalidInput for
  /// another number of vertices.
  PlacementFigures operator()(const Points& placed) const;

 private:
  const TriangleMesh& source_;
  const TriangleMesh& target_;
  std::vector<char> source_in_cavity_;
  Eigen::VectorXd target_areas_;  // n, of what lies in the open, mesh units squared
};

}  // namespace bespoke
