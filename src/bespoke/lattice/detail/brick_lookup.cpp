#include "bespoke/lattice/detail/brick_lookup.h"

#include <algorithm>
#include <string>

#include "bespoke/error.h"
#include "bespoke/instruction_set.h"
#include "bespoke/lattice/detail/looked_up_points.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Points that are located together before any is blended: the walks of all are under way at a time, and their
// cells on the way into the cache. What is known of them takes a quarter of a first-level cache.
constexpr std::size_t block_size = 64;

// Vectors of x, y, z and one lane that means nothing, so that four lanes are one register.
using Lanes = std::array<double, 4>;

template <class T>
using Row = std::array<T, block_size>;

// Points of a block: the float at which the cell's lower corner begins, the strides of its brick, and where
// the point lies in the cell.
struct Located {
  alignas(64) std::array<Row<double>, 3> fraction;
  Row<double> undefined;  // NaN where the point is not finite, else zero
  Row<const float*> corner;
  Row<const BrickShape*> shape;
};

struct Scratch {
  std::array<Row<double>, 3> at;           // in units of places
  std::array<Row<std::int32_t>, 3> place;  // the one that holds it
  Row<double> cells_per_place;
  Row<std::int32_t> corner_mask, last_cell;
  std::array<Row<std::int32_t>, 3> stride;
  Row<std::int32_t> offset;
};

[[gnu::always_inline]] inline void take_apart(const double* x, std::size_t count, Scratch& s) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) s.at[axis][i] = x[3 * i + axis];
}

// Points outside the table's box are moved onto its lower corner, where it is empty.
[[gnu::always_inline]] inline void find_places(const BrickAtlas& atlas, std::size_t count, Scratch& s,
                                               Located& located) {
  for (std::size_t i = 0; i < count; ++i) located.undefined[i] = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double origin = atlas.origin.data()[axis], scale = atlas.places_per_unit;
    const double low = atlas.low[axis], high = atlas.high[axis];
    for (std::size_t i = 0; i < count; ++i) {
      const double coordinate = s.at[axis][i];
      located.undefined[i] += coordinate - coordinate;
      const double place = (coordinate - origin) * scale;
      const bool is_inside = (place >= low) & (place < high);
      const double inside = is_inside ? place : low;
      const auto toward_zero = static_cast<std::int32_t>(inside);
      s.at[axis][i] = inside;
      s.place[axis][i] = toward_zero - (inside < toward_zero ? 1 : 0);
    }
  }
}

[[gnu::always_inline]] inline void find_bricks(const BrickAtlas& atlas, std::size_t count, Scratch& s,
                                               Located& located) {
  constexpr std::uint32_t number = (1u << BrickAtlas::number_bits) - 1;
  Row<BrickTable::Reference> reference;
  atlas.table.find(s.place[0].data(), s.place[1].data(), s.place[2].data(), count, reference.data());
  for (std::size_t i = 0; i < count; ++i) {
    const BrickShape& shape = atlas.shapes[reference[i] >> BrickAtlas::number_bits];
    located.shape[i] = &shape;
    located.corner[i] = atlas.values.get() + shape.first + (reference[i] & number) * shape.floats;
    s.cells_per_place[i] = shape.cells_per_place;
    s.corner_mask[i] = shape.corner_mask;
    s.last_cell[i] = shape.last_cell;
    s.stride[0][i] = shape.stride_x;
    s.stride[1][i] = shape.stride_y;
  }
}

// Places are multiples of powers of two, so all of this is exact.
[[gnu::always_inline]] inline void find_cells(std::size_t count, Scratch& s, Located& located) {
  for (std::size_t i = 0; i < count; ++i) s.stride[2][i] = 3;
  for (std::size_t i = 0; i < count; ++i) s.offset[i] = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < count; ++i) {
      const double corner = s.place[axis][i] & s.corner_mask[i];
      const double in_brick = (s.at[axis][i] - corner) * s.cells_per_place[i];
      // A point a hair below a brick's upper face may be rounded onto it.
      const std::int32_t cell = std::min(static_cast<std::int32_t>(in_brick), s.last_cell[i]);
      located.fraction[axis][i] = in_brick - cell;
      s.offset[i] += cell * s.stride[axis][i];
    }
  for (std::size_t i = 0; i < count; ++i) located.corner[i] += s.offset[i];
}

// A cell's four edges along z begin at these, in the order of x, y.
[[gnu::always_inline]] inline std::array<const float*, 4> rows_of(const Located& located, std::size_t i) {
  const float* corner = located.corner[i];
  const std::int32_t x = located.shape[i]->stride_x, y = located.shape[i]->stride_y;
  return {corner, corner + y, corner + x, corner + x + y};
}

[[gnu::always_inline]] inline void fetch(std::size_t count, const Located& located) {
  constexpr int last_float = 5;  // of the two nodes of an edge, which may lie in two lines of the cache
  for (std::size_t i = 0; i < count; ++i)
    for (const float* row : rows_of(located, i)) {
      __builtin_prefetch(row);
      __builtin_prefetch(row + last_float);
    }
}

[[gnu::always_inline]] inline void interpolate(const Lanes& low, const Lanes& high, double f, Lanes& result) {
  for (std::size_t c = 0; c < 4; ++c) result[c] = low[c] + f * (high[c] - low[c]);
}

[[gnu::always_inline]] inline void subtract(const Lanes& from, const Lanes& what, Lanes& result) {
  for (std::size_t c = 0; c < 4; ++c) result[c] = from[c] - what[c];
}

// Along z, between a node and the next.
[[gnu::always_inline]] inline void interpolate(const float* node, double f, Lanes& result) {
  for (std::size_t c = 0; c < 4; ++c) {
    const double low = node[c];
    result[c] = low + f * (node[c + 3] - low);
  }
}

[[gnu::always_inline]] inline void interpolate_rows(const Located& located, std::size_t i,
                                                    std::array<Lanes, 4>& along_z) {
  const std::array<const float*, 4> rows = rows_of(located, i);
  for (std::size_t row = 0; row < 4; ++row) interpolate(rows[row], located.fraction[2][i], along_z[row]);
}

struct Value {
  static constexpr std::size_t doubles = 3;

  [[gnu::always_inline]] static void write(const Located& located, std::size_t i, double* u) {
    const double x = located.fraction[0][i], y = located.fraction[1][i];
    std::array<Lanes, 4> along_z;
    interpolate_rows(located, i, along_z);
    Lanes low, high, sum;
    interpolate(along_z[0], along_z[1], y, low);
    interpolate(along_z[2], along_z[3], y, high);
    interpolate(low, high, x, sum);
    for (std::size_t c = 0; c < 4; ++c) u[c] = sum[c] + located.undefined[i];
  }
};

struct Gradient {
  static constexpr std::size_t doubles = 9;

  // Differences of opposite faces of the cell, each bilinear.
  [[gnu::always_inline]] static void write(const Located& located, std::size_t i, double* gradient) {
    const double x = located.fraction[0][i], y = located.fraction[1][i];
    const double scale = located.shape[i]->inverse_voxel_size;
    std::array<Lanes, 4> along_z, step_z;
    interpolate_rows(located, i, along_z);
    const std::array<const float*, 4> rows = rows_of(located, i);
    for (std::size_t row = 0; row < 4; ++row)
      for (std::size_t c = 0; c < 4; ++c) {
        const double low = rows[row][c];
        step_z[row][c] = rows[row][c + 3] - low;
      }
    Lanes low, high, difference;
    interpolate(along_z[0], along_z[1], y, low);
    interpolate(along_z[2], along_z[3], y, high);
    subtract(high, low, difference);
    for (std::size_t c = 0; c < 4; ++c) gradient[c] = scale * difference[c];
    subtract(along_z[1], along_z[0], low);
    subtract(along_z[3], along_z[2], high);
    interpolate(low, high, x, difference);
    for (std::size_t c = 0; c < 4; ++c) gradient[3 + c] = scale * difference[c];
    interpolate(step_z[0], step_z[1], y, low);
    interpolate(step_z[2], step_z[3], y, high);
    interpolate(low, high, x, difference);
    for (std::size_t c = 0; c < 4; ++c) gradient[6 + c] = scale * difference[c];
  }
};

[[gnu::always_inline]] inline void locate(const BrickAtlas& atlas, const double* x, std::size_t count,
                                          Located& located) {
  Scratch scratch;
  take_apart(x, count, scratch);
  find_places(atlas, count, scratch, located);
  find_bricks(atlas, count, scratch, located);
  find_cells(count, scratch, located);
  fetch(count, located);
}

template <class What>
struct LookUp {
  [[gnu::always_inline]] static void run(const BrickAtlas& atlas, const double* x, std::size_t count,
                                         double* result) {
    for (std::size_t first = 0; first < count; first += block_size) {
      const std::size_t size = std::min(block_size, count - first);
      Located located;
      locate(atlas, x + 3 * first, size, located);
      double* to = result + What::doubles * first;
      // One lane too many is written, which the next point overwrites; the last point has none.
      for (std::size_t i = 0; i + 1 < size; ++i) What::write(located, i, to + What::doubles * i);
      std::array<double, What::doubles + 1> last;
      What::write(located, size - 1, last.data());
      std::copy_n(last.data(), What::doubles, to + What::doubles * (size - 1));
    }
  }
};

template <class What>
void look_up_all(const BrickAtlas& atlas, std::span<const double> x, std::span<double> result) {
  if (x.size() % 3 != 0 || result.size() != What::doubles * (x.size() / 3))
    throw InvalidInput("look-up: " + std::to_string(x.size()) + " coordinates of points for " +
                       std::to_string(result.size()) + " results");
  parallel_for(x.size() / 3, points_per_chunk, [&](std::size_t begin, std::size_t end) {
    run_dispatched<LookUp<What>>(atlas, x.data() + 3 * begin, end - begin,
                                 result.data() + What::doubles * begin);
  });
}

}  // namespace

void look_up(const BrickAtlas& atlas, std::span<const double> x, std::span<double> u) {
  look_up_all<Value>(atlas, x, u);
}

void look_up_gradient(const BrickAtlas& atlas, std::span<const double> x, std::span<double> gradient) {
  look_up_all<Gradient>(atlas, x, gradient);
}

}  // namespace bespoke
