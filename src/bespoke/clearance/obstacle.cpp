#include "bespoke/clearance/obstacle.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/length.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

// What a band can tell ends at its rim, where values are cut off: this share of it is required at most.
constexpr double told_by_band = 0.9;

// Half a voxel: a gradient over less shows the seams between cells.
constexpr double step_in_voxels = 0.5;

// Of the source's diagonal: what lies no deeper inside may be outside, for all that a grid of 128 voxels
// tells (a twentieth of a voxel), and is kept outside. Twice as much pushes what was modelled into the body.
constexpr double touching = 4e-4;

// Of the source's diagonal: where the change of clearance is judged, and of the target's what may remain of
// it: two thirds of the 0.15 % that 95 % are to keep.
constexpr double near_share = 0.02, looseness = 0.001;

}  // namespace

Obstacle body_obstacle(std::shared_ptr<const ModelDistances> distances, const ModelSizes& sizes,
                       const ClearanceRule& rule) {
  const double most = told_by_band * distances->target.band();
  if (rule.ease && !(*rule.ease <= most))
    throw InvalidInput("a clearance of " + format_number(*rule.ease, 4) + " is more than the " +
                       format_number(most, 4) + " that the map's file can tell (three of its voxels)");
  Obstacle body;
  body.name = "the target";
  body.short_is_breach = rule.ease.has_value();
  body.step = step_in_voxels * distances->target.voxel_size();
  body.tolerance = clearance_tolerance * sizes.target_diagonal;
  body.required = [=](const SourcePlaces& places) {
    std::vector<double> required = places.distances(distances->source);
    for (double& value : required) {
      const double depth = value > -touching * sizes.source_diagonal ? std::max(value, 0.0) : value;
      value = std::min(rule.ease.value_or(sizes.scale() * depth), most);
    }
    return required;
  };
  body.distance = [=](const Points& x) { return distances->target(x); };
  body.with_uncertainty = [=](const Points& x) { return distances->target.with_uncertainty(x); };
  return body;
}

Obstacle body_attraction(std::shared_ptr<const ModelDistances> distances, const ModelSizes& sizes) {
  const double farthest =
      std::min(near_share * sizes.source_diagonal, told_by_band * distances->source.band());
  const double most = told_by_band * distances->target.band();
  Obstacle body;
  body.name = "the target, from where they came";
  body.is_soft = true;
  body.step = step_in_voxels * distances->target.voxel_size();
  body.tolerance = clearance_tolerance * sizes.target_diagonal;
  body.required = [=](const SourcePlaces& places) {
    std::vector<double> required = places.distances(distances->source);
    for (double& value : required) {
      const double length = sizes.scale() * value + looseness * sizes.target_diagonal;
      value = value >= 0 && value < farthest && length < most ? -length
                                                              : -std::numeric_limits<double>::infinity();
    }
    return required;
  };
  body.distance = [=](const Points& x) {
    std::vector<double> values = distances->target(x);
    for (double& value : values) value = -value;
    return values;
  };
  return body;
}

}  // namespace bespoke
