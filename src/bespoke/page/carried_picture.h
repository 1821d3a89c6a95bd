#pragma once

#include <string>
#include <vector>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/mapping/mapping.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What a map makes of a model and what it wears, from the front of the source: the target, or before t = 1
/// the source on its way, with the carried products. Products without faces are left out.
struct CarriedScene {
  const ElasticMap& elastic;
  RigidTransform target_from_source;
  MotionOptions motion;
  double t = 1;
  const TriangleMesh& source;
  const TriangleMesh& target;
  const std::vector<TriangleMesh>& products;
  /// Where products were moved off the target at t = 1: 3×n each, target frame; or empty.
  std::vector<Points> cleared = {};
};

/// A square PNG of `size` (> 0) pixels; the same scene gives the same bytes. Throws InvalidInput for models
/// without vertices.
std::string carried_picture(const CarriedScene& scene, int size);

}  // namespace bespoke
