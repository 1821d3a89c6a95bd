#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/elastic/detail/element_distortion.h"

namespace bespoke {

/// Places and what they require of u; they must outlive the objective.
struct ElementData {
  const Points& places;               ///< 3×n, mesh units
  const Points& wanted;               ///< 3×n, u there, mesh units
  const std::vector<double>& shares;  ///< n, of the weight
};

/// Distortion plus data, Σ_i weight · shareᵢ/2 · |u(vᵢ) − uᵢ|², on one set of elements, as a function of the
/// coefficients (3×unknowns). Places outside of all cells have no term.
class ElementObjective {
 public:
  ElementObjective(const NestedElements& elements, const ElementData& data, const DistortionBounds& bounds);

  void set_bounds(const DistortionBounds& bounds);
  void set_weight(double weight) { weight_ = weight; }
  void set_shares(const std::vector<double>& shares);  ///< n

  /// The energy and, where it is finite, its gradient. The distortion is computed once for coefficients that
  /// are those of the last call.
  double operator()(const Points& coefficients, Points& gradient);

  /// About the inverse of the Hessian's diagonal at the state of the last call, one number per unknown.
  Eigen::VectorXd inverse_diagonal() const;

  /// Shortens a step of the coefficients at all nodes whose functions reach a cell that the last call found
  /// beyond the bounds, so that a few cells do not stop all others.
  void damp(Points& step) const;

  /// |u(vᵢ) − uᵢ|, mesh units.
  std::vector<double> residuals(const Points& coefficients) const;

  /// The places at a corner of a cell beyond these bounds.
  std::vector<std::size_t> squeezed(const Points& coefficients, const DistortionBounds& bounds) const;

  std::size_t outside() const;                                  ///< places without a term
  const Distortion& distortion() const { return distortion_; }  ///< of the last call

 private:
  struct Term {
    std::vector<ElementPlace> places;  // per level; the last is in a finest cell
    Vector3 wanted;
    double share = 1;
  };

  const NestedElements& elements_;
  DistortionBounds bounds_;
  std::vector<Term> terms_;
  std::vector<std::vector<double>> data_diagonal_;  // of the Hessian for weight 1, per point and level
  double weight_ = 0;
  Distortion distortion_;
  Points at_;                                                      // the last call's coefficients
  std::vector<Points> values_, distortion_gradients_, gradients_;  // of the last call, per level
  std::vector<double> scratch_;                                    // of add_distortion
};

}  // namespace bespoke
