#pragma once

#include <memory>

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// E in another unit: x ↦ E(scale · x) / scale, where `scale` > 0 is how many units of E are in one of x. A
/// chain stays a chain of as many steps; with a scale of 1 the map itself comes back.
std::shared_ptr<const ElasticMap> in_other_unit(std::shared_ptr<const ElasticMap> map, double scale);

/// Γ in the same unit: its translation divided by `scale`.
RigidTransform in_other_unit(const RigidTransform& transform, double scale);

}  // namespace bespoke
