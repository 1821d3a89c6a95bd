#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bespoke/bake/pyramid/memory_budget.h"
#include "bespoke/bake/pyramid/nearness.h"
#include "bespoke/bake/pyramid/octant_refinement.h"
#include "bespoke/bake/pyramid/refinement_options.h"
#include "bespoke/bake/pyramid/relaxed_regions.h"
#include "bespoke/bake/pyramid/sampled_levels.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Grows the nested pyramid of a map (src/bespoke/README.md, "Bake"): octants that miss u by more than the
/// tolerance get a leaf of the next level (OctantRefinement), steep level boundaries get neighbours
/// (rim_neighbours). No voxel is smaller than half the tolerance, which suffices for ‖∇u‖ ≤ 2; smaller ones
/// chase a jump. RefinementOptions::max_leaves bounds the leaves: the last ones go to the largest errors and
/// to the largest errors times voxel sizes in turn. Copies share the samples.
class PyramidBuilder {
 public:
  /// The band at the coarsest level. `map` and `progress` must outlive the builder. Throws MemoryLimitError.
  PyramidBuilder(const ElasticMap& map, const RefinementOptions& options, const Progress& progress);

  /// What the leaves are for: a tenth of max_leaves is kept for folds, then for faces that turn (FaceTurns),
  /// until free_reserve().
  enum class Purpose { tolerance, reserved };

  /// Adds leaves until every octant passes. Throws MemoryLimitError as soon as a forecast says that the
  /// leaves will not fit (MemoryBudget).
  void refine();

  /// Gives the finest leaf around each point one below it, whatever its error; where the point lies in a cell
  /// at a level boundary, adds the leaves beyond the level boundary instead. Points outside all leaves are
  /// left alone. Returns the number of leaves added; call refine() afterwards.
  std::size_t refine_at(const Points& x, Purpose purpose = Purpose::tolerance);

  /// From now on leaves may be for any purpose. Returns whether octants wait for them; call refine() then.
  bool free_reserve();

  /// Where octants that do not pass have no leaf of their own, since leaves are bounded.
  std::vector<RelaxedRegion> relaxed() const;

  /// Rounded, without empty leaves (stored_pyramid).
  Pyramid pyramid() const;

  /// Coarsest level of the band.
  const Lattice& coarsest() const { return coarsest_; }
  const std::vector<LeafCoordinates>& band() const { return band_; }
  std::size_t evaluated_points() const;
  /// No voxel is smaller, mesh units.
  double min_voxel() const { return min_voxel_of_tolerance * options_.tolerance_of_places(); }
  /// What the leaves so far need, values and samples.
  std::size_t byte_count() const { return MemoryBudget::bytes_for(levels_.leaf_count()); }

 private:
  struct Looked {
    std::size_t leaves = 0;   // whose octants were tested, the first so many of the level
    bool rims_known = false;  // no level boundary has changed since they were looked at
  };
  struct WantedLeaf {
    std::size_t level;
    LeafCoordinates leaf;
    auto operator<=>(const WantedLeaf&) const = default;
  };

  void add(std::size_t level, std::vector<LeafCoordinates> leaves);
  void refine_level(std::size_t level);
  void refuse(std::size_t level, const std::vector<FailingOctant>& octants);
  bool add_worst_refused();
  std::vector<RefusedOctant> worst_refused(std::size_t most);
  std::size_t leaves_left(Purpose purpose) const;
  void close_rims();
  std::vector<LeafCoordinates> rims_within_budget(std::size_t level);
  std::optional<std::size_t> first_untested_level() const;
  std::optional<std::size_t> first_level_of_unknown_rims() const;
  std::vector<WantedLeaf> leaves_wanted_at(const Vector3& x) const;
  NodeValues nodes_of(std::size_t level) const;
  bool is_finest(std::size_t level) const;

  const ElasticMap& map_;
  RefinementOptions options_;
  double rim_tolerance_;  // largest jump at a level boundary, mesh units: the tolerance, more where leaves
                          // are few
  const Progress& progress_;
  Lattice coarsest_;
  std::vector<LeafCoordinates> band_;
  SampledLevels levels_;
  std::vector<Looked> looked_;  // by level
  OctantRefinement octants_;
  MemoryBudget budget_;
  std::vector<RefusedOctant> refused_;
  bool next_by_size_ = false;                 // what worst_refused goes by next
  std::shared_ptr<const Nearness> nearness_;  // once something was refused, where there is a surface
  std::size_t reserve_;                       // leaves for what is worse than a missed tolerance
  std::size_t sampled_points_ = 0;
};

}  // namespace bespoke
