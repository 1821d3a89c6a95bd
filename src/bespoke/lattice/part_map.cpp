#include "bespoke/lattice/part_map.h"

#include <string>
#include <utility>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/lattice/detail/brick_lookup.h"
#include "bespoke/lattice/detail/looked_up_points.h"
#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {
namespace {

Support support_of(const PyramidPart& part) {
  Pyramid outline;
  outline.origin = part.read.origin;
  for (std::size_t level = 0; level < part.leaves.size(); ++level)
    outline.levels.push_back({part.read.levels[level].voxel_size, part.leaves[level], {}});
  return support_of(outline);
}

/// Values that were not read are NaN; `columns` of the result belong to a point.
void require_read(const Points& x, const Points& result, Eigen::Index columns) {
  if (result.allFinite()) return;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (x.col(i).allFinite() && !result.middleCols(columns * i, columns).allFinite())
      throw OutsidePart("point " + std::to_string(i) + " (" + std::to_string(x(0, i)) + ", " +
                        std::to_string(x(1, i)) + ", " + std::to_string(x(2, i)) +
                        ") lies outside the part of the map that was read; read the whole map");
}

}  // namespace

PartMap::PartMap(AffineMap affine, PyramidPart part) : affine_(std::move(affine)) {
  require_valid(part);
  support_ = support_of(part);
  index_.emplace(part);
  atlas_ = make_brick_atlas(part, *index_);
  if (atlas_)
    index_.reset();
  else
    pyramid_ = std::move(part.read);  // the index points at its values, which do not move in memory
}

Points PartMap::displacement(const Points& x) const {
  Points u(3, x.cols());
  if (atlas_)
    look_up(*atlas_, as_span(x), as_span(u));
  else
    u = look_up(pyramid_, *index_, x);
  require_read(x, u, 1);
  return u;
}

Points PartMap::displacement_gradient(const Points& x) const {
  Points gradient(3, 3 * x.cols());
  if (atlas_)
    look_up_gradient(*atlas_, as_span(x), as_span(gradient));
  else
    gradient = look_up_gradient(pyramid_, *index_, x);
  require_read(x, gradient, 3);
  return gradient;
}

}  // namespace bespoke
