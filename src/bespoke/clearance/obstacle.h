#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/asset/model_distances.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// What a product must stay clear of: a body, or a layer below it.
struct Obstacle {
  std::string name;  ///< for messages: "the target", "shirt.obj"
  /// The distance that points of the product need after the map, by where they were on the source (3×n,
  /// source frame); minus infinity where nothing is required. Target's mesh units.
  SignedDistances required;
  /// Signed distance at points in the target frame (3×n), positive outside, mesh units.
  SignedDistances distance;
  /// By what such a distance may be off, ≥ 0; or empty. What was outside keeps at least that distance.
  SignedDistances uncertainty = {};
  double step = 0;       ///< over which a difference of distances is a gradient, mesh units, > 0
  double tolerance = 0;  ///< by which a requirement may be missed, mesh units
  /// Whether what is short of its distance, and yet outside, breaches the rule: where an ease is required.
  bool short_is_breach = false;
};

/// What clearance is required.
struct ClearanceRule {
  /// At least that distance, target's mesh units. Without it each point keeps the one that it had.
  std::optional<double> ease;
};

/// Of the sizes of two models: what is a length of the source on the target (power_of_two_scale).
struct ModelSizes {
  double source_diagonal = 0;  ///< mesh units, > 0
  double target_diagonal = 0;  ///< mesh units, > 0
  double scale() const;        ///< a power of two
};

/// Misses of this share of the target's diagonal are none: 0.2 mm on a person, as fine as garments are
/// modelled.
inline constexpr double clearance_tolerance = 1e-4;

/// The target of a map. Keeping: s times the distance from the source, at most what the target's band can
/// tell; with s the scale of the sizes. What touched the source stays outside. Throws InvalidInput for more
/// ease than the band can tell.
Obstacle body_obstacle(std::shared_ptr<const ModelDistances> distances, const ModelSizes& sizes,
                       const ClearanceRule& rule);

/// A layer below: `before` as it lies on the source, `after` (3×n, its vertices) on the target. Points that
/// were on its outer side within `reach` stay there, as far away as they were, and as they were where they
/// passed through it: samples within a face's length of such places require nothing.
Obstacle layer_obstacle(std::string name, const TriangleMesh& before, const Points& after,
                        const ModelSizes& sizes);

}  // namespace bespoke
