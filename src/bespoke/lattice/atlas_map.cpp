#include "bespoke/lattice/atlas_map.h"

#include <optional>
#include <utility>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/lattice/detail/brick_lookup.h"
#include "bespoke/lattice/detail/looked_up_points.h"

namespace bespoke {

AtlasMap::AtlasMap(AffineMap affine, BrickAtlas atlas, Support support)
    : affine_(std::move(affine)), atlas_(std::move(atlas)), support_(std::move(support)) {}

Points AtlasMap::displacement(const Points& x) const {
  Points u(3, x.cols());
  look_up(atlas_, as_span(x), as_span(u));
  return u;
}

Points AtlasMap::displacement_gradient(const Points& x) const {
  Points gradient(3, 3 * x.cols());
  look_up_gradient(atlas_, as_span(x), as_span(gradient));
  return gradient;
}

std::shared_ptr<const ElasticMap> loaded_map(AffineMap affine, Pyramid pyramid) {
  require_valid(pyramid);
  if (std::optional<BrickAtlas> atlas = make_brick_atlas(pyramid))
    return std::make_shared<const AtlasMap>(std::move(affine), *std::move(atlas), support_of(pyramid));
  return std::make_shared<const BakedMap>(std::move(affine), std::move(pyramid));
}

}  // namespace bespoke
