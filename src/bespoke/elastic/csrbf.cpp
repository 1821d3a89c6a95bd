#include "bespoke/elastic/csrbf.h"

#include <cstdio>
#include <utility>

#include "bespoke/elastic/detail/exact_map_bytes.h"
#include "bespoke/rbf/layer_stack.h"

namespace bespoke {

std::string to_string(const CsrbfSummary& summary) {
  char text[240];
  std::snprintf(
      text, sizeof text,
      "%zu centres, %.0f entries a row, factor %.3g M entries, condition about %.1e, residual %.3g, "
      "%.2f s",
      summary.estimate.centers, summary.estimate.entries_per_row,
      double(summary.estimate.factor_entries) / 1e6, summary.estimate.condition, summary.residual,
      summary.seconds);
  return text;
}

std::vector<Figure> figures(const CsrbfSummary& summary) {
  const CsrbfEstimate& estimate = summary.estimate;
  return {{"centers", estimate.centers},
          {"entries_per_row", estimate.entries_per_row},
          {"factor_entries", estimate.factor_entries},
          {"condition_estimate", estimate.condition},
          {"center_residual_max", summary.residual}};
}

CsrbfMap::CsrbfMap(Points centers, Points coefficients, AffineMap affine, double lambda)
    : centers_(std::move(centers)),
      coefficients_(std::move(coefficients)),
      affine_(std::move(affine)),
      lambda_(lambda),
      stack_(std::make_shared<LayerStack>(
          std::vector<LayerEvaluator>{LayerEvaluator(centers_, coefficients_, lambda_, Wendland::c4)},
          Stacking::summed)) {}

Points CsrbfMap::displacement(const Points& x) const { return stack_->displacement(x); }

Points CsrbfMap::displacement_gradient(const Points& x) const { return stack_->gradient(x); }

Support CsrbfMap::support() const { return {{}, {{centers_, lambda_}}}; }

void write_exact(const CsrbfMap& map, ExactMapWriter& writer) {
  writer.affine(map.affine());
  writer.number(map.lambda());
  writer.points(map.centers());
  writer.points(map.coefficients());
}

std::shared_ptr<const CsrbfMap> read_csrbf(ExactMapReader& reader) {
  const AffineMap affine = reader.affine();
  const double lambda = reader.positive("lambda");
  Points centers = reader.points("centres");
  Points coefficients = reader.points("coefficients");
  reader.end();
  if (centers.cols() != coefficients.cols()) reject_exact_map("as many coefficients as centres are needed");
  return std::make_shared<CsrbfMap>(std::move(centers), std::move(coefficients), affine, lambda);
}

}  // namespace bespoke
