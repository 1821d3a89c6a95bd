#pragma once

#include <bitset>
#include <cstddef>
#include <memory>
#include <vector>

#include "bespoke/bake/detail/leaf_forecast.h"
#include "bespoke/bake/sampling.h"
#include "bespoke/lattice/finest_cells.h"
#include "bespoke/lattice/leaf_table.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

struct RefinementOptions {
  double tolerance = 0;        ///< wanted largest |baked − exact|, > 0, mesh units
  std::size_t max_memory = 0;  ///< bytes, of all that a bake holds for the leaves at a time
  ValuePrecision precision = ValuePrecision::single;
};

/// Grows the nested pyramid of a map (src/bespoke/README.md, "Bake"). An octant of a leaf gets a leaf of the
/// next level where the sum so far misses u by more than the tolerance. Where a level ends, the residual of
/// its outermost nodes drops to zero within one cell, which adds a gradient of about |r| / h: so neighbours
/// are added until |r| ≤ min(tolerance, 0.3 h) at every rim.
///
/// No voxel is smaller than half the tolerance: voxels of that size meet it wherever ‖∇u‖ ≤ 2 or so, and
/// smaller ones only chase a jump of u, which none meets. Where such a place is left the tolerance is missed.
///
/// Copies share the samples, which are most of the memory.
class PyramidBuilder {
 public:
  /// The band at the coarsest level. `map` must outlive the builder. Throws MemoryLimitError.
  PyramidBuilder(const ElasticMap& map, const RefinementOptions& options, const Progress& progress);

  /// Adds leaves until every octant passes. Throws MemoryLimitError, naming the tolerance that would fit, as
  /// soon as a forecast (LeafForecast) says that the leaves will not; only small pyramids go without one.
  void refine();

  /// Gives the finest leaf around each point one below it, whatever its error; where the point lies in a cell
  /// at a rim, adds the leaves beyond the rim instead. Points outside all leaves are left alone. Returns the
  /// number of leaves added; call refine() afterwards.
  std::size_t refine_at(const Points& x);

  /// Residuals are taken against the sum of the coarser levels as they are stored, that is, rounded.
  Pyramid pyramid() const;

  /// Coarsest level of the band.
  const Lattice& coarsest() const { return coarsest_; }
  const std::vector<LeafCoordinates>& band() const { return band_; }
  std::size_t evaluated_points() const { return evaluated_points_; }
  /// What the leaves so far need, values and samples.
  std::size_t byte_count() const;

 private:
  struct Level {
    Lattice lattice;
    std::vector<LeafCoordinates> leaves;  // in the order they came
    std::vector<const float*> samples;    // u, not residuals: these change whenever a coarser leaf comes
    std::vector<std::shared_ptr<const std::vector<float>>> batches;  // hold the samples
    LeafTable table;
    std::size_t tested = 0;   // leaves whose octants were looked at
    bool rims_known = false;  // no rim has changed since they were looked at
  };

  void add(std::size_t level, std::vector<LeafCoordinates> leaves);
  Level& make_level(std::size_t level);
  std::vector<LeafCoordinates> octants_to_refine(std::size_t level);
  std::vector<LeafCoordinates> octants_in_question(std::size_t level) const;
  std::vector<LeafCoordinates> rim_neighbours(std::size_t level) const;
  void close_rims();
  void sum_block(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const;
  void coarse_block(std::size_t level, const LeafCoordinates& leaf, NodeBlock& sum) const;
  std::bitset<8> missing_blocks(std::size_t level, const LeafCoordinates& leaf) const;
  void want_leaf_at(const Vector3& x, std::vector<std::vector<LeafCoordinates>>& wanted) const;
  std::size_t leaf_count() const;
  bool is_finest(std::size_t level) const;
  double rounding_at(const Vector3& u) const;
  void round_level(PyramidLevel& stored, std::size_t level, const std::vector<std::size_t>& order);
  void require_room(std::size_t leaves);

  const ElasticMap& map_;
  RefinementOptions options_;
  const Progress& progress_;
  Support support_;
  Lattice coarsest_;
  std::vector<LeafCoordinates> band_;
  std::vector<Level> levels_;
  std::shared_ptr<const LeafForecast> forecast_;
  std::size_t evaluated_points_ = 0;
};

}  // namespace bespoke
