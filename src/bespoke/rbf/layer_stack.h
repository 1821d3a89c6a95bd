#pragma once

#include <vector>

#include "bespoke/rbf/layer_evaluator.h"
#include "bespoke/types.h"

namespace bespoke {

/// How the layers of a stack act on a point.
enum class Stacking {
  summed,    ///< y = x + Σ u_k(x)
  composed,  ///< y = (id + u_n) ∘ … ∘ (id + u_1) (x)
};

/// Layers one after another. Sums run in an order that depends on centres and points alone, in `double`
/// without contraction, so results have the same bits on every instruction set and at any thread count.
class LayerStack {
 public:
  LayerStack(std::vector<LayerEvaluator> layers, Stacking stacking);

  /// y − x at the columns of x (3×n, mesh units); exactly zero where no layer reaches. Any order of points;
  /// they are sorted by place first.
  Points displacement(const Points& x) const;

  /// ∇(y − x) at the columns of x: 3×3n, three columns per point, no unit.
  Points gradient(const Points& x) const;

 private:
  Points evaluate(const Points& x, LayerEvaluator::Order order) const;

  std::vector<LayerEvaluator> layers_;
  Stacking stacking_;
};

}  // namespace bespoke
