#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/elastic/space_guides.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/progress.h"
#include "bespoke/statistics.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;

struct FiniteElementOptions {
  double lambda = 0;         ///< effective distance around the source, > 0, mesh units
  double fit_tolerance = 0;  ///< how far a vertex may be missed, > 0, mesh units of the targets
  /// Largest factor by which a volume and a length may shrink relative to the affine part, at the nodes of
  /// cells; > 1, no unit. Vertices that need more are missed.
  double max_squeeze = 50;
  double max_length_squeeze = 10;
  int max_levels = 5;               ///< of nested elements, > 0: the finest have λ/4 · 2^(1 − max_levels)
  std::size_t max_nodes = 180'000;  ///< no level is added beyond, > 0; about 30 bytes each in a file
  std::size_t max_memory = std::size_t{8} << 30;  ///< bytes
  AffinePart affine_part = AffinePart::least_squares;
  bool give_up_blocked = false;  ///< on the coarsest level where the minimiser is blocked (summary)
  /// They count as vertices do, so that space turns with the surface beneath it, but change neither the
  /// affine part nor what the summary says, and halve no cell.
  SpaceGuides guides = {};
};

struct FiniteElementSummary {
  std::vector<double> voxel_sizes;  ///< mesh units, one per level
  std::vector<std::size_t> nodes;   ///< with an unknown, one per level
  std::vector<std::size_t> cells;   ///< finest cells, one per level
  std::vector<std::size_t>
      iterations;              ///< of the minimiser, one per run: when a level was added, or places loosened
  double distortion = 0;       ///< weighted mean of the symmetric Dirichlet energy, 0 for an affine map
  double min_determinant = 0;  ///< at the nodes of cells, relative to the affine part, no unit
  Statistics residuals;        ///< |E(vᵢ) − v'ᵢ|, mesh units of the targets
  std::size_t loosened = 0;    ///< places that gave way to the bounds
  bool blocked = false;        ///< on the coarsest level cells at their bounds held the minimiser up
  std::size_t outside = 0;     ///< places too far from the source for any cell
  double seconds = 0;
};

/// One line.
std::string to_string(const FiniteElementSummary& summary);
std::vector<Figure> figures(const FiniteElementSummary& summary);

struct FiniteElementFit {
  std::shared_ptr<const BakedMap> map;
  FiniteElementSummary summary;
};

/// E = affine ∘ (id + u), sources to targets (3×n, mesh units), with least ∫ κ ψ(I + ∇u) dx + Σ_i w/2 |u(vᵢ)
/// − uᵢ|², ψ the symmetric Dirichlet energy (Smith, Schaefer 2015) and barriers (element_distortion.h), κ as
/// in element_weights.h, w = (mean area of a vertex) / (a tenth of the fit tolerance), by limited-memory
/// BFGS. u is trilinear on nested cells, zero beyond λ and one coarse cell. No iterate flips a cell. Throws
/// InvalidInput (sizes, values, affine part with det ≤ 0), SolverError, MemoryLimitError, Interrupted.
FiniteElementFit fit_finite_elements(const Points& sources, const Points& targets, const TriangleMesh& source,
                                     const FiniteElementOptions& options, const Progress& progress = {});

/// Its bytes (exact_map_io.h): the affine part and the levels. Reading throws FormatError.
void write_exact(const BakedMap& map, ExactMapWriter& writer);
std::shared_ptr<const BakedMap> read_baked(ExactMapReader& reader);

}  // namespace bespoke
