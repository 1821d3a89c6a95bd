#include "bespoke/anchors/anchor_audit.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "bespoke/anchors/detail/biharmonic_warp.h"
#include "bespoke/error.h"
#include "bespoke/median.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {
namespace {

constexpr std::size_t min_audited_pairs = 8;
constexpr double typical_factor = 4;
constexpr double min_share = 0.04;  // of the targets' diagonal: proportions of bodies differ that much

}  // namespace

AnchorAudit audit_anchors(const Anchors& anchors) {
  const Points sources = source_points(anchors), targets = target_points(anchors);
  if (!(sources.allFinite() && targets.allFinite()))
    throw InvalidInput("an anchor has a coordinate that is not finite");
  AnchorAudit audit;
  std::vector<Eigen::Index> trusted(anchors.pairs.size());
  std::iota(trusted.begin(), trusted.end(), 0);
  if (trusted.size() < min_audited_pairs) return audit;

  const std::size_t must_stay = std::max(trusted.size() - trusted.size() / 3, min_audited_pairs - 2);
  std::vector<Eigen::Index> suspects;
  for (;;) {
    const Points trusted_targets = targets(Eigen::all, trusted);
    const BiharmonicWarp warp(sources(Eigen::all, trusted), trusted_targets);
    std::vector<double> distances;
    for (std::size_t k = 0; k < trusted.size(); ++k)
      distances.push_back(warp.left_out(static_cast<Eigen::Index>(k)));
    audit.typical_distance = median(distances);
    const auto worst = std::max_element(distances.begin(), distances.end());
    const double limit =
        std::max(min_share * diagonal(trusted_targets), typical_factor * *audit.typical_distance);
    if (!(*worst > limit) || trusted.size() <= must_stay) {
      for (const Eigen::Index i : suspects) {
        const double distance = (warp(sources.col(i)) - targets.col(i)).norm();
        // Set aside beside a worse pair that had bent the warp around it.
        if (!(distance > limit)) continue;
        SuspiciousAnchor suspicious{static_cast<std::size_t>(i),
                                    anchors.pairs[static_cast<std::size_t>(i)].name, distance, std::nullopt};
        double best = 0.5 * distance;
        for (const Eigen::Index j : suspects) {
          const double mine = (warp(sources.col(i)) - targets.col(j)).norm();
          const double other = (warp(sources.col(j)) - targets.col(i)).norm();
          if (j == i || !(mine < best) || !(other < 0.5 * (warp(sources.col(j)) - targets.col(j)).norm()))
            continue;
          best = mine;
          suspicious.swapped_with = static_cast<std::size_t>(j);
        }
        audit.suspicious.push_back(suspicious);
      }
      break;
    }
    const auto position = trusted.begin() + (worst - distances.begin());
    suspects.push_back(*position);
    trusted.erase(position);
  }
  std::stable_sort(
      audit.suspicious.begin(), audit.suspicious.end(),
      [](const SuspiciousAnchor& a, const SuspiciousAnchor& b) { return a.distance > b.distance; });
  return audit;
}

std::string to_string(const AnchorAudit& audit, const Anchors& anchors) {
  std::string text;
  for (const SuspiciousAnchor& anchor : audit.suspicious) {
    char distance[120];
    std::snprintf(distance, sizeof distance, " lies %.4g from where the others put it (typical: %.4g)",
                  anchor.distance, audit.typical_distance.value_or(0));
    text += (text.empty() ? "anchor " : "; anchor ") + label(anchors, anchor.index) + distance;
    if (anchor.swapped_with) text += ", looks swapped with " + label(anchors, *anchor.swapped_with);
  }
  return text;
}

}  // namespace bespoke
