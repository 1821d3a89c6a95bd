#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/surface_fit/deformation_graph_settings.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {

/// A vertex of the source should lie in a plane.
struct PlanePair {
  int vertex = 0;
  Vector3 point;      ///< of the plane, diagonals
  Vector3 normal;     ///< unit, halfway between both surfaces' (symmetric point to plane)
  double weight = 0;  ///< diagonals squared: the area that the pair represents, times the squared agreement
                      ///< of the normals, times its direction's share
  /// 0 to 1: how much it counts also from far off. The pair's reciprocity (reciprocity.h), times how sharply
  /// the searching surface is creased there (crease.h) or, where the source lies outside the target, how
  /// certainly anchors determine its pose (pose_certainty.h), whichever is more.
  double outlier_scale_gain = 0;
};

/// Where pairs are looked for.
struct PairSurfaces {
  const TargetSurface& source;  ///< where the source is now
  const TargetSurface& target;
  /// n: what each vertex represents, diagonals squared; 0 leaves it out, as a counterpart too
  const Eigen::VectorXd& source_areas;
  const Eigen::VectorXd& target_areas;
  /// n, of a source that anchors have bent (pose_certainty.h); null of another.
  const Eigen::VectorXd* pose_certainty = nullptr;
};

/// Closest compatible points of evenly chosen vertices, from the source to the target first, then back. A
/// target vertex pulls on the nearest corner of the face that it finds. Vertices that find nothing give no
/// pair; those of a patch look in the other surface's same patch only.
std::vector<PlanePair> find_plane_pairs(const PairSurfaces& surfaces, const NodeLevel& level,
                                        const NodeFitSettings& settings);

}  // namespace bespoke
