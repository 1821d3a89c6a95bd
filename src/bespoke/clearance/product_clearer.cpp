#include "bespoke/clearance/product_clearer.h"

#include <utility>

#include "bespoke/clearance/detail/corrected_map.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

/// Whether their boxes are nearer to each other on the source than the larger one is long: shoes and a hat
/// are no layers.
bool may_touch(const WornProduct& a, const WornProduct& b) {
  const Box first = bounding_box(a.prepared->mesh().vertices),
            second = bounding_box(b.prepared->mesh().vertices);
  return first.exteriorDistance(second) < 0.1 * std::max(first.diagonal().norm(), second.diagonal().norm());
}

}  // namespace

std::shared_ptr<const ElasticMap> ProductClearer::corrected(WornProduct product, const ClearanceMap& map) {
  if (!map.distances)
    throw InvalidInput(
        "the map holds no distances of its models for clearance, since an older bespoke made it; make it "
        "anew "
        "by `bespoke fit`");
  const Points carried = carried_vertices(product, *map.elastic, map.target_from_source);
  std::vector<Obstacle> obstacles = {body_obstacle(map.distances, map.sizes, rule_)};
  if (rule_.same && !rule_.ease) obstacles.push_back(body_attraction(map.distances, map.sizes));
  for (const Layer& layer : layers_)
    if (layer.product.prepared->mesh().faces.cols() > 0 && may_touch(layer.product, product))
      obstacles.push_back(
          layer_obstacle(layer.product.name, layer.product.prepared->mesh(), layer.after, map.sizes));
  ClearedProduct cleared = keep_clear(*product.prepared, carried, obstacles);
  ProductClearance found{product.name, std::move(cleared.summary), {}};
  for (const Layer& layer : layers_)
    found.layers.push_back(layer_contact(layer.product, layer.after, product, cleared.vertices));
  found_.push_back(std::move(found));
  std::shared_ptr<const ElasticMap> corrected =
      corrected_map(map.elastic, map.target_from_source, product.prepared->mesh(), carried, cleared.vertices);
  if (products_ == Products::layers) layers_.push_back({std::move(product), std::move(cleared.vertices)});
  return corrected;
}

}  // namespace bespoke
