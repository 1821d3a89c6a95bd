#include "bespoke/anchors/contradicting_anchors.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {

std::vector<ContradictingAnchors> contradicting_anchors(const Anchors& anchors) {
  constexpr std::size_t min_pairs = 4;
  constexpr double near = 0.05;  // of the targets' diagonal
  std::vector<ContradictingAnchors> found;
  if (anchors.pairs.size() < min_pairs) return found;
  const Points sources = source_points(anchors), targets = target_points(anchors);
  if (!(diagonal(sources) > 0)) return found;  // the rigid part says so
  const Points aligned = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols())) * sources;
  const double reach = near * diagonal(targets);
  for (Eigen::Index i = 0; i < aligned.cols(); ++i)
    for (Eigen::Index j = i + 1; j < aligned.cols(); ++j) {
      if (!(is_exact(anchors.pairs[static_cast<std::size_t>(i)]) &&
            is_exact(anchors.pairs[static_cast<std::size_t>(j)])))
        continue;
      const Vector3 arm = aligned.col(j) - aligned.col(i);
      const double asked = (targets.col(j) - targets.col(i) - arm).norm();
      if (arm.norm() < reach && asked > arm.norm())
        found.push_back({static_cast<std::size_t>(i), static_cast<std::size_t>(j), arm.norm(), asked});
    }
  std::stable_sort(found.begin(), found.end(),
                   [](const ContradictingAnchors& a, const ContradictingAnchors& b) {
                     return a.asked * b.apart > b.asked * a.apart;
                   });
  return found;
}

std::string to_string(const std::vector<ContradictingAnchors>& contradicting, const Anchors& anchors) {
  constexpr std::size_t most_named = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(contradicting.size(), most_named); ++k) {
    const ContradictingAnchors& pair = contradicting[k];
    char distances[120];
    std::snprintf(distances, sizeof distances, " (%.3g apart, targets off by %.3g)", pair.apart, pair.asked);
    text += (text.empty() ? "anchors " : "; ") + label(anchors, pair.first) + " and " +
            label(anchors, pair.second) + distances;
  }
  if (contradicting.size() > most_named)
    text += " and " + std::to_string(contradicting.size() - most_named) + " more";
  if (!text.empty()) text += " contradict each other; give those that are not exact a sigma";
  return text;
}

}  // namespace bespoke
