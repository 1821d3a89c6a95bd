#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/asset/model_distances.h"
#include "bespoke/clearance/clearance_rule.h"
#include "bespoke/clearance/source_places.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {

/// A layer as it lies on the source, and where its vertices are (3×n) on the target.
struct LayerFaces {
  TriangleMesh before;
  Points after;
};

/// What places of a product have to stay above, a plane each.
struct SidePlanes {
  Points origins, normals;       ///< 3×k, target frame; normals of unit length
  std::vector<double> required;  ///< distances from the planes, mesh units; minus infinity where none is
};

/// What a product must stay clear of: a body, or a layer below it.
struct Obstacle {
  std::string name;  ///< for messages: "the target", "shirt.obj"
  /// The distance that points of the product need after the map, by where they were on the source; minus
  /// infinity where nothing is required. Target's mesh units.
  std::function<std::vector<double>(const SourcePlaces&)> required;
  /// Of a layer, instead of `required`, `distance` and `uncertainty`: by where places were on the source
  /// (3×k).
  std::function<SidePlanes(const Points& x)> planes = {};
  /// Signed distance at points in the target frame (3×n), positive outside, mesh units.
  SignedDistances distance;
  /// The same with what it may be off by, or empty. What was outside keeps at least that distance.
  std::function<UncertainDistances(const Points& x)> with_uncertainty = {};
  double step = 0;       ///< over which a difference of distances is a gradient, mesh units, > 0
  double tolerance = 0;  ///< by which a requirement may be missed, mesh units
  /// Of a layer, else null: no face of the product passes through one of it that did not on the source, and
  /// the product is looked at where the layer's vertices, edges and faces are nearest on the source, too.
  std::shared_ptr<const LayerFaces> layer = nullptr;
  double layer_reach = 0;  ///< from the product to them, on the source, mesh units
  /// Whether what is short of its distance, and yet outside, breaches the rule: where an ease is required.
  bool short_is_breach = false;
  /// Whether what misses it moves as a bystander may and no farther, and is no miss to tell of.
  bool is_soft = false;
};

/// Misses of this share of the target's diagonal are none: 0.2 mm on a person, as fine as garments are
/// modelled.
inline constexpr double clearance_tolerance = 1e-4;

/// The target of a map. Keeping: s times the distance from the source, at most what the target's band can
/// tell; with s the scale of the sizes. What touched the source stays outside. Throws InvalidInput for more
/// ease than the band can tell.
Obstacle body_obstacle(std::shared_ptr<const ModelDistances> distances, const ModelSizes& sizes,
                       const ClearanceRule& rule);

/// The same target from its other side, soft: places within 2 % of the source's diagonal are drawn back to
/// where they are 0.1 % of the target's diagonal farther away than on the source.
Obstacle body_attraction(std::shared_ptr<const ModelDistances> distances, const ModelSizes& sizes);

/// A layer below: `before` as it lies on the source, `after` (3×n, its vertices) on the target. Places that
/// were on its outer side stay above the plane at the place of it that was nearest, as far as they were:
/// where sheets lie near each other, in an armpit, none is taken for another. What was under it is left to
/// the pairs of faces.
Obstacle layer_obstacle(std::string name, const TriangleMesh& before, const Points& after,
                        const ModelSizes& sizes);

}  // namespace bespoke
