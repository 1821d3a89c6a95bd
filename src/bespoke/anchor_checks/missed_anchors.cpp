#include "bespoke/anchor_checks/missed_anchors.h"

#include <algorithm>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/number_format.h"

namespace bespoke {

std::vector<MissedAnchor> missed_anchors(const Anchors& anchors, const std::vector<double>& residuals,
                                         const std::vector<double>& sigmas, double resolution) {
  constexpr double missed_sigmas = 4;  // 1 in 16,000 of normal errors
  if (residuals.size() != anchors.pairs.size() || sigmas.size() != anchors.pairs.size())
    throw InvalidInput(std::to_string(anchors.pairs.size()) + " pairs, but " +
                       std::to_string(residuals.size()) + " residuals and " + std::to_string(sigmas.size()) +
                       " accuracies");
  std::vector<MissedAnchor> missed;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (std::isinf(anchors.pairs[i].weight) && residuals[i] > missed_sigmas * std::max(sigmas[i], resolution))
      missed.push_back({i, residuals[i], sigmas[i]});
  std::stable_sort(missed.begin(), missed.end(), [&](const MissedAnchor& a, const MissedAnchor& b) {
    return a.residual * std::max(b.sigma, resolution) > b.residual * std::max(a.sigma, resolution);
  });
  return missed;
}

std::string to_string(const std::vector<MissedAnchor>& missed, const Anchors& anchors) {
  constexpr std::size_t max_named = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(missed.size(), max_named); ++k)
    text += (k == 0 ? "anchor " : "; anchor ") + label(anchors, missed[k].index) + " is missed by " +
            format_number(missed[k].residual, 3) +
            (missed[k].sigma > 0
                 ? ", " + format_number(missed[k].residual / missed[k].sigma, 3) + " times its sigma"
                 : ", though it is exact");
  if (missed.size() > max_named) text += " and " + std::to_string(missed.size() - max_named) + " more";
  return text;
}

}  // namespace bespoke
