#include "bespoke/clearance/obstacle.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/length.h"
#include "bespoke/number_format.h"
#include "bespoke/quality/signed_distance.h"

namespace bespoke {
namespace {

constexpr double nothing_required = -std::numeric_limits<double>::infinity();

// What a band can tell ends at its rim, where values are cut off: this share of it is required at most.
constexpr double told_by_band = 0.9;

// Half a voxel: a gradient over less shows the seams between cells.
constexpr double step_in_voxels = 0.5;

// Layers farther apart than this share of the diagonal are not in each other's way: two bands of the grids.
constexpr double layer_reach = 0.025;

// Far below the distance of layers, far above rounding.
constexpr double layer_step = 1e-5;

// Of the source's diagonal: what lies no deeper inside may be outside, for all that a grid of 128 voxels
// tells (a twentieth of a voxel), and is kept outside. Twice as much pushes what was modelled into the body.
constexpr double touching = 4e-4;

/// Of a layer before and after. Where the nearest place is on its rim it has no side.
struct Layer {
  SignedDistance before, after;
  double scale, reach;

  std::vector<double> required(const Points& x) const {
    const SignedDistance::Values values = before(x);
    std::vector<double> result(values.distance.size(), nothing_required);
    for (std::size_t i = 0; i < result.size(); ++i)
      if (values.sided[i] && values.distance[i] > 0 && values.distance[i] < reach)
        result[i] = scale * values.distance[i];
    return result;
  }

  std::vector<double> distance(const Points& x) const {
    SignedDistance::Values values = after(x);
    for (std::size_t i = 0; i < values.distance.size(); ++i)
      if (!values.sided[i]) values.distance[i] = scale * reach;
    return std::move(values.distance);
  }
};

}  // namespace

double ModelSizes::scale() const { return power_of_two_scale(target_diagonal / source_diagonal); }

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
  body.required = [=](const Points& x) {
    std::vector<double> required = distances->source(x);
    for (double& value : required) {
      const double depth = value > -touching * sizes.source_diagonal ? std::max(value, 0.0) : value;
      value = std::min(rule.ease.value_or(sizes.scale() * depth), most);
    }
    return required;
  };
  body.distance = [=](const Points& x) { return distances->target(x); };
  body.uncertainty = [=](const Points& x) { return distances->target.uncertainty(x); };
  return body;
}

Obstacle layer_obstacle(std::string name, const TriangleMesh& before, const Points& after,
                        const ModelSizes& sizes) {
  const auto layer =
      std::make_shared<const Layer>(Layer{SignedDistance(before), SignedDistance({after, before.faces}),
                                          sizes.scale(), layer_reach * sizes.source_diagonal});
  Obstacle obstacle;
  obstacle.name = std::move(name);
  obstacle.step = layer_step * sizes.target_diagonal;
  obstacle.tolerance = clearance_tolerance * sizes.target_diagonal;
  obstacle.required = [layer](const Points& x) { return layer->required(x); };
  obstacle.distance = [layer](const Points& x) { return layer->distance(x); };
  return obstacle;
}

}  // namespace bespoke
