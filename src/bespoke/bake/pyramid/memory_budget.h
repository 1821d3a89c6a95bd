#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "bespoke/bake/pyramid/leaf_forecast.h"
#include "bespoke/bake/pyramid/refinement_options.h"

namespace bespoke {

/// Refuses a bake that will not fit, as early as a forecast can tell.
class MemoryBudget {
 public:
  /// `band`: the leaves of the coarsest lattice. `map` and `progress` must outlive the budget.
  MemoryBudget(const ElasticMap& map, const Lattice& coarsest, std::vector<LeafCoordinates> band,
               const RefinementOptions& options, const Progress& progress);

  /// Throws MemoryLimitError, naming the tolerance that would fit, when so many leaves, or those that a
  /// forecast expects (made once they are more than a few), take more than the memory.
  void require_space_for(std::size_t leaves);

  /// What so many leaves need, values and samples.
  static std::size_t bytes_for(std::size_t leaves);

  std::size_t evaluated_points() const { return forecast_ ? forecast_->evaluated_points() : 0; }

 private:
  double expected_leaves();
  [[noreturn]] void refuse(std::size_t leaves, double expected) const;

  const ElasticMap& map_;
  Lattice coarsest_;
  std::vector<LeafCoordinates> band_;
  RefinementOptions options_;
  const Progress& progress_;
  std::shared_ptr<const LeafForecast> forecast_;
};

}  // namespace bespoke
