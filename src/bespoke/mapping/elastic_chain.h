#pragma once

#include <memory>
#include <vector>

#include "bespoke/mapping/elastic_map.h"

namespace bespoke {

/// Elastic maps one after the other, E = E_K ∘ … ∘ E_1, all in the source frame: how a map is stored whose
/// parts turn further than one displacement can. One step is the common case, and gives that step's own bits.
class ElasticChain : public ElasticMap {
 public:
  /// Throws InvalidInput without steps.
  explicit ElasticChain(std::vector<std::shared_ptr<const ElasticMap>> steps);

  const std::vector<std::shared_ptr<const ElasticMap>>& steps() const { return steps_; }

  /// The affine parts composed. u is what is left, and exactly zero where every step's is.
  AffineMap affine() const override;
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;

  /// Of all steps, each seen through the affine parts of those before it: no more than that can be said
  /// without following points through the steps.
  Support support() const override;

  /// The motion at t, where step k takes place from (k−1)/K to k/K, along straight lines: the first ⌊tK⌋
  /// steps and a fraction of the next. x at 0 and E(x) at 1; t beyond [0, 1] extends the first or the last
  /// step. With one step (1−t) x + t E(x). Throws InvalidInput when t is not finite.
  Points at(const Points& x, double t) const;

  /// The same for many times from one pass through the steps.
  std::vector<Points> at(const Points& x, const std::vector<double>& times) const;

 private:
  std::vector<std::shared_ptr<const ElasticMap>> steps_;
};

}  // namespace bespoke
