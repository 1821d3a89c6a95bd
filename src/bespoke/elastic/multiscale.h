#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bespoke/elastic/elastic_fit.h"
#include "bespoke/elastic/space_guides.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"
#include "bespoke/rbf/rbf_layer.h"
#include "bespoke/statistics.h"

namespace bespoke {

class ExactMapReader;
class ExactMapWriter;

struct MultiscaleOptions {
  /// Coarsest support radius, > 0, mesh units: the effective distance where the layers act, which is around
  /// the targets where they are composed.
  double lambda = 0;
  double tolerance = 0;  ///< refine where |E(vᵢ) − v'ᵢ| exceeds it, > 0, mesh units
  bool composed = true;  ///< diffeomorphic: layers are composed and each is bounded by ‖∇u_k‖ < 1 everywhere;
                         ///< otherwise summed
  int max_levels = 12;
  AffinePart affine_part = AffinePart::least_squares;
  /// Met as well (their offset is measured where lambda is), within 5 % of their offset and by layers whose
  /// λ_k is no smaller than it: finer ones are the surface's alone. They change neither the affine part nor
  /// what the summary says.
  SpaceGuides guides = {};
};

struct MultiscaleSummary {
  std::vector<double> lambdas;          ///< mesh units, one per layer
  std::vector<std::size_t> centers;     ///< one per layer
  std::vector<double> gradient_bounds;  ///< proved bound of ‖∇u_k‖, one per layer (composed only)
  Statistics residuals;                 ///< |E(vᵢ) − v'ᵢ|, mesh units
  std::size_t within_tolerance = 0;     ///< vertices
  double seconds = 0;
};

/// One line.
std::string to_string(const MultiscaleSummary& summary);
std::vector<Figure> figures(const MultiscaleSummary& summary);

/// Residual correction over halved scales (Floater–Iske, Wendland), summed: E(x) = affine(x) + Σ u_k(x), or
/// composed: E = (id + u_n)∘…∘(id + u_1)∘affine, which cannot fold. Layers use Wendland's C2 function.
class MultiscaleMap : public ElasticMap {
 public:
  MultiscaleMap(AffineMap affine, std::vector<RbfLayer> layers, bool composed);
  ~MultiscaleMap() override;

  AffineMap affine() const override { return affine_; }
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

  const std::vector<RbfLayer>& layers() const { return layers_; }
  bool composed() const { return composed_; }

 private:
  struct Evaluators;
  AffineMap affine_;
  std::vector<RbfLayer> layers_;
  bool composed_;
  std::unique_ptr<const Evaluators> evaluators_;
};

/// Its bytes (exact_map_io.h). Reading throws FormatError.
void write_exact(const MultiscaleMap& map, ExactMapWriter& writer);
std::shared_ptr<const MultiscaleMap> read_multiscale(ExactMapReader& reader);

struct MultiscaleFit {
  std::shared_ptr<const MultiscaleMap> map;
  MultiscaleSummary summary;
};

/// A composed map as two: the affine part and the first half of the layers, and the other half after it. The
/// residuals are those at the end, so the first has none. Throws InvalidInput for a map that is summed or has
/// less than two layers.
std::array<MultiscaleFit, 2> halves(const MultiscaleMap& map, const MultiscaleSummary& summary);

/// E(sources) ≈ targets, 3×n each, mesh units, after the least-squares affine map or similarity (the identity
/// along directions without extent). Centres are λ_k/4 apart; λ_k is halved while a residual exceeds the
/// tolerance. A composed scale takes several layers where residuals are clipped to 0.3 λ_k, or a layer is
/// damped to ‖∇u_k‖ ≤ 0.9; contradicting data stays in the residuals. Throws InvalidInput (sizes, non-finite
/// values, affine part with det ≤ 0, values out of range), SolverError.
MultiscaleFit fit_multiscale(const Points& sources, const Points& targets, const MultiscaleOptions& options,
                             const Progress& progress = {});

}  // namespace bespoke
