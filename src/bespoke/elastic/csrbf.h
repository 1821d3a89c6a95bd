#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;
class LayerStack;

/// What the one-scale system of Eq. 16 would cost; known before anything is factored.
struct CsrbfEstimate {
  std::size_t centers = 0;
  double entries_per_row = 0;      ///< mean number of centres within λ of a centre
  std::size_t factor_entries = 0;  ///< of the Cholesky factor (symbolic factorisation); 0 when another limit
                                   ///< already forbids to look
  std::size_t bytes = 0;           ///< at the worst moment: matrix, factor and temporary fronts
  double condition = 0;       ///< estimate, grows like (λ/h)⁷ with h the median spacing of the centres
  double median_spacing = 0;  ///< h, mesh units
  bool within_limits = false;
  double advised_lambda = 0;  ///< λ when within the limits below, else about the largest that is (mesh
                              ///< units); 0 when there is none
};

struct CsrbfOptions {
  double lambda = 0;                              ///< effective distance, > 0, mesh units
  std::size_t max_memory = std::size_t{4} << 30;  ///< bytes for matrix and factor
  double max_condition = 1e13;  ///< beyond it the coefficients have no correct digit left to spare
};

struct CsrbfSummary {
  CsrbfEstimate estimate;
  double residual = 0;  ///< after iterative refinement: max over centres of |E(vᵢ) − v'ᵢ|, mesh units
  double seconds = 0;
};

/// Throws InvalidInput for fewer than 4 sources, non-finite or duplicate ones, or a λ that is not positive.
CsrbfEstimate estimate_csrbf(const Points& sources, const CsrbfOptions& options);

/// One line: centres, entries a row, factor size, condition, residual, seconds.
std::string to_string(const CsrbfSummary& summary);
std::vector<Figure> figures(const CsrbfSummary& summary);

/// The paper's elastic map (Eq. 16–17): Σ cᵢ φ(|x − vᵢ|/λ) + a₀ + A x with Wendland's C4 function, the affine
/// tail by the Schur complement of the sparse Cholesky factor.
class CsrbfMap : public ElasticMap {
 public:
  CsrbfMap(Points centers, Points coefficients, AffineMap affine, double lambda);

  AffineMap affine() const override { return affine_; }
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

  const Points& centers() const { return centers_; }            ///< 3×n, mesh units
  const Points& coefficients() const { return coefficients_; }  ///< 3×n, mesh units
  double lambda() const { return lambda_; }                     ///< mesh units

 private:
  Points centers_;
  Points coefficients_;
  AffineMap affine_;
  double lambda_;
  std::shared_ptr<const LayerStack> stack_;
};

/// Its bytes (exact_map_io.h). Reading throws FormatError.
void write_exact(const CsrbfMap& map, ExactMapWriter& writer);
std::shared_ptr<const CsrbfMap> read_csrbf(ExactMapReader& reader);

struct CsrbfFit {
  std::shared_ptr<const CsrbfMap> map;
  CsrbfSummary summary;
};

/// E(sources) = targets (3×n each, mesh units). Throws InvalidInput for duplicate or coplanar sources;
/// MemoryLimitError or SolverError, with the advised λ in the message, before factoring when the estimate
/// exceeds a limit.
CsrbfFit fit_csrbf(const Points& sources, const Points& targets, const CsrbfOptions& options,
                   const Progress& progress = {});

}  // namespace bespoke
