#pragma once

#include <array>

#include "bespoke/enum_names.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// In which order the rigid and the elastic part of Ψ(t) act. All but the first are for comparison.
enum class MappingOrder {
  elastic_first,  ///< Eq. 1, the mapping: R(t)·((1−t) x + t E(x)) + t T
  rigid_first,   ///< Fig. 4: rigid motion at t first, then t times the elastic change, which is read at x and
                 ///< turned into the target frame: R(t) x + t T + t R (E(x) − x)
  moving_point,  ///< Eq. 19 as printed: with y = R(t) x + t T, the moving point, (1−t) y + t E'(y), where
                 ///< E' = Γ∘E∘Γ⁻¹ is the elastic map between the models in the target frame
  linear,        ///< Fig. 1: (1−t) x + t (R E(x) + T)
};

inline constexpr std::array mapping_orders{Named<MappingOrder>{"elastic-first", MappingOrder::elastic_first},
                                           Named<MappingOrder>{"rigid-first", MappingOrder::rigid_first},
                                           Named<MappingOrder>{"moving-point", MappingOrder::moving_point},
                                           Named<MappingOrder>{"linear", MappingOrder::linear}};

/// The rigid part of Ψ and how it is travelled.
struct MotionOptions {
  RotationPath path = RotationPath::geodesic;
  MappingOrder order = MappingOrder::elastic_first;
};

/// Where Ψ(t) requires E, for points x (3×n, source frame, mesh units): Γ⁻¹(R(t) x + t T) in the order of the
/// moving point, x itself in all others and at both ends, so that many t cost one lookup. Throws InvalidInput
/// when t is not finite.
Points elastic_argument(const Points& x, const RigidTransform& target_from_source, double t,
                        const MotionOptions& options = {});

/// Ψ(t) at points x, given `elastic_image`, E at elastic_argument(x, …, t, …), 3×n. Ψ(0) is the identity and
/// Ψ(1) = Γ∘E in every order and on every path, exactly. t may lie outside [0, 1] (extrapolation). Throws
/// InvalidInput when t is not finite or the sizes differ.
Points move_points(const Points& x, const Points& elastic_image, const RigidTransform& target_from_source,
                   double t, const MotionOptions& options = {});

}  // namespace bespoke
