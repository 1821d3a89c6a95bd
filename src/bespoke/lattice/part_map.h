#pragma once

#include <optional>

#include "bespoke/error.h"
#include "bespoke/lattice/brick_atlas.h"
#include "bespoke/lattice/pyramid_index.h"
#include "bespoke/lattice/pyramid_part.h"
#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// A point requires values of a map that were not read; the message names it.
class OutsidePart : public InvalidInput {
  using InvalidInput::InvalidInput;
};

/// The elastic map of a pyramid of which a part was read: where it has values, with the bits of loaded_map of
/// the whole; elsewhere it throws OutsidePart. (The bits of an AtlasMap and a BakedMap differ, and which of
/// them the whole would be is known except for displacements above 1e38, which are not read.)
class PartMap : public ElasticMap {
 public:
  /// Throws InvalidInput for a part that is not valid.
  PartMap(AffineMap affine, PyramidPart part);

  AffineMap affine() const override { return affine_; }
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override { return support_; }  ///< of the whole

 private:
  AffineMap affine_;
  Support support_;
  std::optional<BrickAtlas> atlas_;
  Pyramid pyramid_;  // empty where there is an atlas, as is the index
  std::optional<PyramidIndex> index_;
};

}  // namespace bespoke
