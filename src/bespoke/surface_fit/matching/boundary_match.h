#pragma once

#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"
#include "bespoke/surface_fit/surface_fit.h"

namespace bespoke {

/// What a vertex of the source's boundary finds on the target's boundary.
struct BoundaryMatch {
  int vertex = 0;
  double length = 0;  ///< half of the boundary edges at the vertex, mesh units
  Vector3 point;      ///< mesh units
  Vector3 tangent;    ///< unit, of the target's boundary
};

struct BoundaryMatchInput {
  const TargetSurface& source_rest;  ///< the source, aligned
  const Points& anchors;             ///< 3×k, on the source, aligned with it, mesh units
  const TargetSurface& target;       ///< must outlive the matcher
  BoundaryRule rule = BoundaryRule::automatic;
};

/// Ties the cuts of open models to each other. Whether two cuts are the same place of the body cannot be seen
/// from the surfaces; unless the caller rules it, a boundary of the source counts as the same cut when
/// meeting the target's boundary stretches the strip between it and the nearest anchor little enough for most
/// of its vertices (settings).
class BoundaryMatcher {
 public:
  explicit BoundaryMatcher(const BoundaryMatchInput& input, const BoundarySettings& settings = {});

  /// Decides, once, with the source's vertices (3×n) where they are when only surfaces and anchors were met.
  void decide(const Points& vertices);

  /// Closest points on the target's boundary for all vertices of the accepted boundaries.
  std::vector<BoundaryMatch> match(const Points& vertices) const;

  int matched_boundaries() const { return matched_boundaries_; }
  int boundaries() const { return boundaries_; }

 private:
  BoundaryMatch closest(int vertex, const Points& vertices) const;

  const TargetSurface& target_;
  BoundaryRule rule_;
  BoundarySettings settings_;
  std::vector<int> vertices_;   // of the source's boundaries
  std::vector<int> boundary_;   // of each of them: which one
  std::vector<double> length_;  // of each, mesh units
  std::vector<double> anchor_distance_;
  std::vector<char> accepted_;  // per boundary
  int boundaries_ = 0;
  int matched_boundaries_ = 0;
};

}  // namespace bespoke
