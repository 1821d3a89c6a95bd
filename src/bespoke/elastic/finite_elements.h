#pragma once

#include <memory>
#include <string>
#include <vector>

#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"

namespace bespoke {

struct FiniteElementOptions {
  double lambda = 0;     ///< effective distance around the sources, > 0, mesh units
  double tolerance = 0;  ///< cells are halved where a vertex is missed by more, > 0, mesh units
  /// How far a vertex gives way under unit stress, > 0, mesh units.
  double compliance = 0;
  int max_levels = 6;
  int iterations = 60;   ///< of the minimiser, at most, per level
  AffinePart affine_part = AffinePart::least_squares;
};

struct FiniteElementSummary {
  std::vector<double> voxel_sizes;       ///< mesh units, one per level
  std::vector<std::size_t> nodes;        ///< with an unknown, one per level
  std::vector<std::size_t> cells;        ///< finest cells, one per level
  std::vector<int> iterations;           ///< per level added
  double energy = 0;
  double min_determinant = 0;            ///< at the corners of finest cells, relative to the affine part
  Statistics residuals;                  ///< |E(vᵢ) − v'ᵢ|, mesh units
  double seconds = 0;
};

struct FiniteElementFit {
  std::shared_ptr<const BakedMap> map;
  FiniteElementSummary summary;
};

FiniteElementFit fit_finite_elements(const ElasticInput& input, const FiniteElementOptions& options,
                                     const Progress& progress = {});

}  // namespace bespoke
