#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bespoke/bake/pyramid/refinement_options.h"
#include "bespoke/bake/pyramid/sampled_levels.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

/// An octant that needs a leaf of the next level.
struct FailingOctant {
  LeafCoordinates leaf{};  ///< the leaf of the next level that would cover it
  double error = 0;        ///< largest at its tested nodes, mesh units
};

/// Finds the octants of leaves in which the sum of the levels misses u by more than the tolerance.
class OctantRefinement {
 public:
  /// `map` and `progress` must outlive it.
  OctantRefinement(const ElasticMap& map, const RefinementOptions& options, const Progress& progress);

  /// Octants of a level's leaves from number `first` on that need a leaf of the next level and have none.
  std::vector<FailingOctant> failing_octants(const SampledLevels& levels, std::size_t level,
                                             std::size_t first);

  std::size_t evaluated_points() const { return evaluated_points_; }

 private:
  std::vector<LeafCoordinates> octants_in_question(const SampledLevels& levels, std::size_t level,
                                                   std::size_t first) const;
  std::uint8_t octants_of_large_residuals(const SampledLevels& levels, std::size_t level,
                                          std::size_t leaf) const;
  LeafTable unresolved_leaves(const SampledLevels& levels, std::size_t level) const;
  double error_in(const SampledLevels& levels, std::size_t level, const LeafCoordinates& octant,
                  const Eigen::Ref<const Points>& exact) const;
  double rounding_at(const Vector3& u) const;
  Eigen::VectorXd errors_at(const Points& x, const Points& found, const Points& exact) const;

  const ElasticMap& map_;
  AffineMap affine_;
  Support support_;
  RefinementOptions options_;
  const Progress& progress_;
  std::size_t evaluated_points_ = 0;
};

}  // namespace bespoke
