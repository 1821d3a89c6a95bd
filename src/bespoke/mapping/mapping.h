#pragma once

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// In which order the rigid and the elastic part of Ψ(t) act.
enum class MappingOrder {
  elastic_first,  ///< Eq. 1, the mapping: R(t)·((1−t) x + t E(x)) + t T
  rigid_first,  ///< Eq. 19, for comparison (Fig. 4): rigid motion at t first, then t times the elastic change
                ///< in the target frame
  linear,       ///< Fig. 1, for comparison: (1−t) x + t (R E(x) + T)
};

/// The rigid part of Ψ and how it is travelled.
struct MotionOptions {
  RotationPath path = RotationPath::geodesic;
  MappingOrder order = MappingOrder::elastic_first;
};

/// Ψ(t) at points x (3×n, source frame, mesh units) whose elastic images E(x) (3×n) are known, so that many t
/// cost one lookup. Ψ(0) is the identity and Ψ(1) = Γ∘E in every order and on every path, exactly. t may lie
/// outside [0, 1] (extrapolation); throws InvalidInput when t is not finite or the sizes differ.
Points move_points(const Points& x, const Points& elastic_image, const RigidTransform& target_from_source,
                   double t, const MotionOptions& options = {});

}  // namespace bespoke
