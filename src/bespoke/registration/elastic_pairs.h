#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// What the elastic map is fitted to: every distinct place that a face of the source uses, and where it goes;
/// then the anchors that lie off the source's surface.
struct ElasticPairs {
  Points sources;                       ///< 3×k, mesh units
  Points targets;                       ///< 3×k; the mean where several vertices share the place
  std::vector<int> referenced;          ///< vertices in some face
  std::size_t unreferenced = 0;         ///< vertices in none
  std::size_t duplicates = 0;           ///< vertices at the place of an earlier one
  std::size_t anchors_off_surface = 0;  ///< pairs at the end that are anchors
};

/// fitted: 3×n, the source's vertices on the target, source frame, mesh units.
ElasticPairs elastic_pairs(const TriangleMesh& source, const Points& fitted);

/// The exact anchors farther than `off_surface` (> 0, mesh units) from the source's surface, by index. The
/// surface carries those that are nearer; one with a weight need not be met.
std::vector<std::size_t> anchors_off_surface(const TriangleMesh& source, const Anchors& anchors,
                                             double off_surface);

/// The pairs with these anchors at the end.
ElasticPairs with_anchors(ElasticPairs pairs, const Anchors& anchors, const std::vector<std::size_t>& which,
                          const RigidTransform& source_from_target);

}  // namespace bespoke
