#include "bespoke/surface_fit/graph/anchor_limits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/statistics.h"

namespace bespoke {

AnchorLimits::AnchorLimits(Eigen::VectorXd sigmas, double area, const AnchorSettings& settings)
    : sigmas_(std::move(sigmas)), area_(area), settings_(settings) {}

std::vector<double> AnchorLimits::next(const FitState& state) {
  std::vector<double> limits(static_cast<std::size_t>(sigmas_.size()),
                             std::numeric_limits<double>::infinity());
  if (!(state.pair_distance > 0)) return limits;
  reinforce(state.anchor_residuals);
  const double patch = state.smoothing * state.smoothing / area_;
  const double variance = reinforcement_ * state.pair_distance * state.pair_distance +
                          settings_.along_surface * settings_.along_surface;
  for (Eigen::Index k = 0; k < sigmas_.size(); ++k)
    if (sigmas_[k] > 0) limits[static_cast<std::size_t>(k)] = patch * variance / (sigmas_[k] * sigmas_[k]);
  return limits;
}

void AnchorLimits::reinforce(const Eigen::VectorXd& residuals) {
  const double expected = std::sqrt(2 * std::log(2.0));  // median length of a normal error in a plane
  std::vector<double> ratios;
  for (Eigen::Index k = 0; k < sigmas_.size(); ++k)
    if (sigmas_[k] > 0) ratios.push_back(residuals[k] / (expected * sigmas_[k]));
  if (ratios.empty()) return;
  const double ratio = summarize(std::move(ratios)).median;
  const double change = std::clamp(ratio * ratio, 1 / settings_.max_reinforced, settings_.max_reinforced);
  reinforcement_ = std::max(1.0, reinforcement_ * change);
}

}  // namespace bespoke
