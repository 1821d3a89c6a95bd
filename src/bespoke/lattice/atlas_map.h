#pragma once

#include <memory>

#include "bespoke/lattice/brick_atlas.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// An elastic map whose u is looked up in a brick atlas: what products are carried with. It differs from the
/// BakedMap of the same pyramid, which the certificate proves, by the rounding of sums to float: a
/// component of u by at most 2⁻²⁴ of its largest at the cell's corners, one of its gradient by at most 2⁻²³
/// of that a voxel of the cell (besides roundings of doubles).
class AtlasMap : public ElasticMap {
 public:
  AtlasMap(AffineMap affine, BrickAtlas atlas, Support support);

  AffineMap affine() const override { return affine_; }
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override { return support_; }

  const BrickAtlas& atlas() const { return atlas_; }

 private:
  AffineMap affine_;
  BrickAtlas atlas_;
  Support support_;
};

/// The fastest map of a pyramid: an AtlasMap, or where make_brick_atlas has none, a BakedMap. Throws
/// InvalidInput for a pyramid that is not valid.
std::shared_ptr<const ElasticMap> loaded_map(AffineMap affine, Pyramid pyramid);

}  // namespace bespoke
