#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

struct PointCloudSummary;

/// What a map is made of: two models and their anchors, in one unit, which the anchors name (Anchors::unit).
/// All is as its user has it: lengths are no fractions of the models, powers of two scale them (length.h).
/// What it refers to must outlive it.
struct Problem {
  const TriangleMesh& source;
  const TriangleMesh& target;
  const Anchors& anchors;
  /// The source already fitted to the target, target frame, same connectivity: surface fitting is skipped.
  const TriangleMesh* fitted = nullptr;
  /// What the target was made of, if it is the surface of a point cloud: the record names that.
  const PointCloudSummary* target_cloud = nullptr;
  /// Names of the groups that the source's vertices belong to, one a vertex, for loose parts; called where
  /// there are any.
  std::function<std::vector<std::string>()> read_source_groups = nullptr;
};

}  // namespace bespoke
