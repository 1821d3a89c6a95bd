#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf.h"
#include "bespoke/types.h"

namespace bespoke {

/// What values are rounded to and stored as.
enum class ValuePrecision {
  single,  ///< 32-bit floats
  half,    ///< 16-bit floats (11 significant bits, up to 65504), in memory as the same 32-bit values
};

/// "single" or "half".
const char* name_of(ValuePrecision precision);

/// The nearest value of half precision, ties to even; infinite beyond its range.
float rounded_to_half(float value);

/// One lattice of the pyramid. Node (i, j, k) lies at origin + voxel_size·(i, j, k).
struct PyramidLevel {
  double voxel_size = 0;                ///< mesh units
  std::vector<LeafCoordinates> leaves;  ///< in lexicographic order, each once
  /// leaf_floats a leaf, in the leaves' order; a node starts at 3·number_of_place within its leaf. Mesh
  /// units.
  std::vector<float> values;

  const float* values_of(std::size_t leaf) const { return values.data() + leaf_floats * leaf; }
  float* values_of(std::size_t leaf) { return values.data() + leaf_floats * leaf; }
};

/// u as a sum of nested, node-aligned lattices (src/bespoke/README.md, "Bake"): node i of a level is node 2 i
/// of the next; each level is trilinear between its nodes and zero outside its leaves (and the one cell
/// around them); a leaf below level 0 lies inside a leaf of the level above. The sum is continuous and
/// trilinear in every finest cell.
struct Pyramid {
  Vector3 origin = Vector3::Zero();  ///< mesh units; node (0, 0, 0) of every level
  std::vector<PyramidLevel> levels;  ///< coarse to fine, voxel_size halved from one to the next
  ValuePrecision precision = ValuePrecision::single;

  Lattice lattice(int level) const { return {origin, levels[static_cast<std::size_t>(level)].voxel_size}; }
  std::size_t leaf_count() const;   ///< all levels
  std::size_t voxel_count() const;  ///< whole leaves, all levels
  std::size_t byte_count() const;   ///< of values and leaf coordinates
};

/// No component of the sum of the levels exceeds it anywhere: bounds the rounding of that sum. Mesh units.
double largest_sum(const Pyramid& pyramid);

/// Rounds u so that its bits say no more than the tolerance (mesh units) requires, and as zeros compress: to
/// multiples of a power of two that is at most a 32nd of it, then to the precision. Zero stays zero. Throws
/// InvalidInput where a value exceeds the range of half precision.
void round_values(std::span<float> values, double tolerance, ValuePrecision precision);

/// Throws InvalidInput, naming the level, unless all of the above holds, every value is finite and of the
/// pyramid's precision.
void require_valid(const Pyramid& pyramid);

}  // namespace bespoke
