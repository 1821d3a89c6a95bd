#include "bespoke/clearance/product_clearer.h"

#include <algorithm>
#include <utility>

#include "bespoke/clearance/corrected_map.h"
#include "bespoke/error.h"

namespace bespoke {
namespace {

// Of the diagonal of the larger of two boxes: products farther apart on the source, as shoes and a hat, are
// not kept from each other. Of two garments as large as their model it is four times a layer's reach.
constexpr double far_apart = 0.1;

/// Whether their boxes are nearer to each other on the source.
bool may_touch(const WornProduct& a, const WornProduct& b) {
  const Box first = bounding_box(a.prepared->mesh().vertices),
            second = bounding_box(b.prepared->mesh().vertices);
  return first.exteriorDistance(second) <
         far_apart * std::max(first.diagonal().norm(), second.diagonal().norm());
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
  std::vector<const Layer*> kept_from;
  for (const Layer& layer : layers_)
    if (layer.product.prepared->mesh().faces.cols() > 0 && may_touch(layer.product, product)) {
      obstacles.push_back(
          layer_obstacle(layer.product.name, layer.product.prepared->mesh(), layer.after, map.sizes));
      kept_from.push_back(&layer);
    }
  ClearedProduct cleared = keep_clear(*product.prepared, carried, obstacles);
  ProductClearance found{product.name, std::move(cleared.summary), {}};
  auto pairs = found.summary.layers.begin();
  for (const Layer& layer : layers_)
    if (std::find(kept_from.begin(), kept_from.end(), &layer) != kept_from.end()) {
      found.layers.push_back({layer.product.name, product.name, pairs->before, pairs->after});
      ++pairs;
    } else {
      found.layers.push_back(layer_contact(layer.product, layer.after, product, cleared.vertices));
    }
  found_.push_back(std::move(found));
  std::shared_ptr<const ElasticMap> corrected =
      corrected_map(map.elastic, map.target_from_source, product.prepared, carried, cleared.vertices);
  if (products_ == Products::layers) layers_.push_back({std::move(product), std::move(cleared.vertices)});
  return corrected;
}

}  // namespace bespoke
