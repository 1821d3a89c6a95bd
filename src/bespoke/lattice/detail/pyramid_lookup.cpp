#include "bespoke/lattice/pyramid_index.h"

#include <algorithm>
#include <cmath>

#include "bespoke/lattice/detail/looked_up_points.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Lattice coordinates of level 0 beyond this are outside every leaf that require_valid admits.
constexpr double coordinate_limit = 1 << 30;

// A cell of an entry, and where a point lies in it.
struct CellPosition {
  LatticeCoordinates cell;         // of the level's lattice
  std::array<double, 3> fraction;  // in [0, 1)
};

CellPosition locate(const std::array<double, 3>& lattice) {
  CellPosition position;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = std::floor(lattice[axis]);
    position.cell[axis] = static_cast<int>(lower);
    position.fraction[axis] = lattice[axis] - lower;
  }
  return position;
}

using Corners = std::array<const float*, 8>;

// The values at a cell's corners, corner (dx, dy, dz) at 4 dx + 2 dy + dz. Straddling cells take the same way
// as inner ones: bit 3 of a node's coordinate says in which neighbour it lies.
inline Corners corners_of(const PyramidEntry& entry, const CellPosition& position) {
  std::array<int, 3> block;  // upper corner's share of the block number
  std::array<int, 3> lower;  // offsets within the block
  std::array<int, 3> upper;
  constexpr std::array<int, 3> stride = {3 * leaf_edge * leaf_edge, 3 * leaf_edge, 3};
  for (int axis = 0; axis < 3; ++axis) {
    const int node = position.cell[axis] & (leaf_edge - 1);
    block[axis] = (node + 1) >> 3 << (2 - axis);
    lower[axis] = node * stride[axis];
    upper[axis] = ((node + 1) & (leaf_edge - 1)) * stride[axis];
  }
  Corners corners;
  for (int corner = 0; corner < 8; ++corner) {
    const bool x = corner & 4, y = corner & 2, z = corner & 1;
    corners[corner] = entry.blocks[(x ? block[0] : 0) + (y ? block[1] : 0) + (z ? block[2] : 0)] +
                      (x ? upper[0] : lower[0]) + (y ? upper[1] : lower[1]) + (z ? upper[2] : lower[2]);
  }
  return corners;
}

inline void add_value(const Corners& corners, const std::array<double, 3>& f, double* sum) {
  for (int c = 0; c < 3; ++c) {
    std::array<double, 4> along_z;
    for (int pair = 0; pair < 4; ++pair) {
      const double low = corners[2 * pair][c];
      along_z[pair] = low + f[2] * (corners[2 * pair + 1][c] - low);
    }
    const double low = along_z[0] + f[1] * (along_z[1] - along_z[0]);
    const double high = along_z[2] + f[1] * (along_z[3] - along_z[2]);
    sum[c] += low + f[0] * (high - low);
  }
}

// Column j of the gradient: difference of opposite faces of the cell, each bilinear.
inline void add_gradient(const Corners& corners, const std::array<double, 3>& f, double scale, double* sum) {
  for (int axis = 0; axis < 3; ++axis) {
    const int step = 4 >> axis;
    const int first = axis == 0 ? 2 : 4;
    const int second = axis == 2 ? 2 : 1;
    const double f1 = f[axis == 0 ? 1 : 0];
    const double f2 = f[axis == 2 ? 1 : 2];
    for (int c = 0; c < 3; ++c) {
      const auto difference = [&](int corner) {
        return static_cast<double>(corners[corner + step][c]) - corners[corner][c];
      };
      const double low = difference(0) + f2 * (difference(second) - difference(0));
      const double high = difference(first) + f2 * (difference(first + second) - difference(first));
      sum[3 * axis + c] += scale * (low + f1 * (high - low));
    }
  }
}

// Calls add(level, corners, fraction) for every level that is not zero at x. Keeps the root entry between
// points, because neighbours in x mostly share it.
class Descent {
 public:
  Descent(const Pyramid& pyramid, const PyramidIndex& index)
      : index_(index),
        origin_(pyramid.origin),
        inverse_voxel_size_(pyramid.levels.empty() ? 0 : 1 / pyramid.levels.front().voxel_size) {}

  template <class Add>
  void operator()(const double* x, const Add& add) {
    if (index_.levels.empty()) return;
    std::array<double, 3> lattice;
    for (int axis = 0; axis < 3; ++axis) {
      lattice[axis] = (x[axis] - origin_[axis]) * inverse_voxel_size_;
      if (!(std::abs(lattice[axis]) < coordinate_limit)) return;
    }
    CellPosition position = locate(lattice);
    const LeafCoordinates leaf = leaf_of(position.cell);
    if (leaf != leaf_ || !known_) {
      leaf_ = leaf;
      known_ = true;
      root_ = index_.roots.find(leaf);
    }
    std::int32_t found = root_;
    for (std::size_t level = 0; found != no_leaf; ++level) {
      const PyramidEntry& entry = index_.levels[level][found];
      add(level, corners_of(entry, position), position.fraction);
      found = entry.children[octant_of_cell(position.cell)];
      if (found == no_leaf) return;
      for (int axis = 0; axis < 3; ++axis) {
        // Doubling is exact, so all levels see the same point.
        const double doubled = 2 * position.fraction[axis];
        const int upper = doubled >= 1 ? 1 : 0;
        position.cell[axis] = 2 * position.cell[axis] + upper;
        position.fraction[axis] = doubled - upper;
      }
    }
  }

 private:
  const PyramidIndex& index_;
  Vector3 origin_;
  double inverse_voxel_size_;
  LeafCoordinates leaf_{};
  bool known_ = false;
  std::int32_t root_ = no_leaf;
};

}  // namespace

Points look_up(const Pyramid& pyramid, const PyramidIndex& index, const Points& x) {
  Points u(3, x.cols());
  parallel_for(static_cast<std::size_t>(x.cols()), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    Descent descend(pyramid, index);
    for (std::size_t i = begin; i < end; ++i) {
      const double* point = x.data() + 3 * i;
      // A point that is not finite has no image: infinity − infinity is NaN.
      std::array<double, 3> sum = {point[0] - point[0], point[1] - point[1], point[2] - point[2]};
      descend(point, [&](std::size_t, const Corners& corners, const std::array<double, 3>& fraction) {
        add_value(corners, fraction, sum.data());
      });
      std::copy(sum.begin(), sum.end(), u.data() + 3 * i);
    }
  });
  return u;
}

Points look_up_gradient(const Pyramid& pyramid, const PyramidIndex& index, const Points& x) {
  Points gradient = Points::Zero(3, 3 * x.cols());
  parallel_for(static_cast<std::size_t>(x.cols()), points_per_chunk, [&](std::size_t begin, std::size_t end) {
    Descent descend(pyramid, index);
    for (std::size_t i = begin; i < end; ++i)
      descend(x.data() + 3 * i, [&](std::size_t level, const Corners& corners,
                                    const std::array<double, 3>& fraction) {
        add_gradient(corners, fraction, 1 / pyramid.levels[level].voxel_size, gradient.data() + 9 * i);
      });
  });
  return gradient;
}

}  // namespace bespoke
