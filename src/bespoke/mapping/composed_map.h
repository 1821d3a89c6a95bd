#pragma once

#include "bespoke/mapping/elastic_map.h"
#include "bespoke/rigid/rigid_transform.h"

namespace bespoke {

/// a→c as b→c after a→b, as an elastic map of its own, to be baked: Γ_ab⁻¹∘E_bc∘Γ_ab∘E_ab in the frame of a,
/// so that Ψ_ac = (Γ_bc Γ_ab)∘(this). Exactly affine outside both supports.
class ComposedMap : public ElasticMap {
 public:
  /// Both maps must outlive the composition.
  ComposedMap(const ElasticMap& b_from_a, const RigidTransform& rigid_b_from_a, const ElasticMap& c_from_b);

  AffineMap affine() const override;
  Points displacement(const Points& x) const override;
  Points displacement_gradient(const Points& x) const override;
  Support support() const override;

 private:
  const ElasticMap& b_from_a_;
  RigidTransform rigid_b_from_a_;
  const ElasticMap& c_from_b_;
};

}  // namespace bespoke
