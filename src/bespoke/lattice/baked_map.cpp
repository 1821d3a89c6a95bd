#include "bespoke/lattice/baked_map.h"

#include <cmath>
#include <utility>

#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {

Support support_of(const Pyramid& pyramid) {
  Support support;
  // Level 0 with the cell around its leaves holds all deeper leaves with theirs. These are listed all the
  // same: a bake of this map refines where balls are small.
  for (const PyramidLevel& level : pyramid.levels) {
    const Lattice lattice{pyramid.origin, level.voxel_size};
    BallCloud cloud;
    cloud.centers.resize(3, static_cast<Eigen::Index>(level.leaves.size()));
    for (std::size_t i = 0; i < level.leaves.size(); ++i)
      cloud.centers.col(static_cast<Eigen::Index>(i)) =
          lattice.at(as_vector(first_node(level.leaves[i])) + Vector3::Constant((leaf_edge - 1) / 2.0));
    cloud.radius = std::sqrt(3.0) * (leaf_edge + 1) / 2.0 * level.voxel_size;
    support.clouds.push_back(std::move(cloud));
  }
  return support;
}

struct BakedMap::Index {
  explicit Index(const Pyramid& pyramid) : tree(pyramid) {}
  PyramidIndex tree;
};

BakedMap::BakedMap(AffineMap affine, Pyramid pyramid)
    : affine_(std::move(affine)), pyramid_(std::move(pyramid)) {
  require_valid(pyramid_);
  index_ = std::make_unique<const Index>(pyramid_);
}

BakedMap::~BakedMap() = default;

Points BakedMap::displacement(const Points& x) const { return look_up(pyramid_, index_->tree, x); }

Points BakedMap::displacement_gradient(const Points& x) const {
  return look_up_gradient(pyramid_, index_->tree, x);
}

Support BakedMap::support() const { return support_of(pyramid_); }

}  // namespace bespoke
