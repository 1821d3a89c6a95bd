#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>

#include "bespoke/lattice/brick_table.h"
#include "bespoke/lattice/pyramid.h"
#include "bespoke/lattice/pyramid_index.h"

namespace bespoke {

/// What all bricks of a level and a kind have in common.
struct BrickShape {
  double cells_per_place = 0;     ///< of the level; a place is an octant of a leaf of the finest level
  double inverse_voxel_size = 0;  ///< of the level, 1 / mesh units
  std::int32_t corner_mask = 0;   ///< leaves of a place what tells the brick's lower corner
  std::int32_t last_cell = 0;     ///< along an axis
  std::int32_t stride_x = 0;      ///< floats from a node to the next
  std::int32_t stride_y = 0;
  std::size_t first = 0;   ///< float in BrickAtlas::values where the bricks of the kind begin
  std::size_t floats = 0;  ///< of a brick
};

/// The sum of a pyramid's levels, once for all: in *bricks*, boxes of cells of the finest level that is not
/// zero there, with u at all their nodes, the upper ones included. A brick is a leaf's 8³ cells with 9³
/// nodes, or an octant's 4³ with 5³ where less than most of the leaf is wanted. Fine cells never straddle
/// coarse ones, so the sum is trilinear in every cell of a brick. A look-up is one walk through the table and
/// one trilinear blend.
struct BrickAtlas {
  /// Reference of a brick: its number among those of its kind, and above that the number of its shape.
  static constexpr int number_bits = 25;
  static constexpr int shape_bits = 6;
  static constexpr int max_levels = 1 << (shape_bits - 1);
  static constexpr int octant_edge = leaf_edge / 2;

  Vector3 origin = Vector3::Zero();     ///< mesh units
  double places_per_unit = 0;           ///< places along a mesh unit
  std::array<double, 3> low{}, high{};  ///< box of the table, in places; `high` is not part of it
  BrickTable table;                     ///< by place; 0 is the brick of zeros, for where u is zero
  std::array<BrickShape, 2 * max_levels> shapes{};  ///< 2·level, plus one for bricks of a whole leaf
  std::unique_ptr<float[]> values;                  ///< three a node, mesh units
  std::size_t value_count = 0;

  std::size_t byte_count() const { return sizeof(float) * value_count + table.byte_count(); }
};

/// Values are the pyramid's sums rounded to float: where they differ from the sum, it is by at most 2⁻²⁴ of
/// it (6e-8). Nothing where the atlas would take more than `largest_share` times the bytes of the pyramid's
/// values, where the pyramid spans more than 2³⁰ of its smallest octants, or where a sum may exceed a float.
std::optional<BrickAtlas> make_brick_atlas(const Pyramid& pyramid, double largest_share = 3);

/// The same where values of a part were read: there the bricks of the whole's atlas, and where one requires
/// other values NaN. Nothing where the whole has no atlas (its sums are those of the part, though). `index`
/// is the part's.
std::optional<BrickAtlas> make_brick_atlas(const PyramidPart& part, const PyramidIndex& index,
                                           double largest_share = 3);

}  // namespace bespoke
