#include "bespoke/anchor_checks/contradicting_anchors.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <optional>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {
namespace {

// Weights fall with this power of the distance: the rotation of a limb is that of the few nearest anchors
// (tests/accuracy/tuning.md).
constexpr double power = 6;
constexpr double min_distance = 0.01;  // of the farthest anchor's: nearer ones weigh no more
constexpr std::size_t min_others = 4;  // fewer tell no turn

/// By least squares of all pairs but two, the nearer to these the more they count; none where these others
/// are few or at one place.
std::optional<Similarity> similarity_around(const Points& sources, const Points& targets, Eigen::Index i,
                                            Eigen::Index j) {
  std::vector<Eigen::Index> others;
  for (Eigen::Index k = 0; k < sources.cols(); ++k)
    if (k != i && k != j) others.push_back(k);
  const Points from = sources(Eigen::all, others), to = targets(Eigen::all, others);
  if (others.size() < min_others || !(diagonal(from) > 0) || !(diagonal(to) > 0)) return std::nullopt;
  const Vector3 middle = 0.5 * (sources.col(i) + sources.col(j));
  const Eigen::ArrayXd distances = (from.colwise() - middle).colwise().norm().transpose();
  return align_similarly(from, to, (distances / distances.maxCoeff()).max(min_distance).pow(-power).matrix());
}

}  // namespace

std::vector<ContradictingAnchors> contradicting_anchors(const Anchors& anchors,
                                                        const std::vector<double>& sigmas) {
  constexpr std::size_t min_pairs = 4;
  // Of the targets' diagonal: the root mean square difference of two places, each accurate to
  // anchor_resolution (anchor_accuracy.h) in every coordinate.
  constexpr double explained = std::numbers::sqrt2 * std::numbers::sqrt3 * 1e-3;
  constexpr double near = 0.05;  // of the targets' diagonal
  std::vector<ContradictingAnchors> found;
  if (anchors.pairs.size() < min_pairs) return found;
  const Points sources = source_points(anchors), targets = target_points(anchors);
  if (!(diagonal(sources) > 0)) return found;  // the rigid part says so
  const Similarity similarity = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols()));
  const double reach = near * diagonal(targets);
  const double noise = explained * diagonal(targets);
  const auto contradicts = [&](const ContradictingAnchors& pair) {
    return pair.target_difference > std::max(pair.source_distance, noise);
  };
  const auto is_met_exactly = [&](std::size_t pair) {
    return is_exact(anchors.pairs[pair]) && (sigmas.empty() || sigmas[pair] == 0);
  };
  for (std::size_t first = 0; first < anchors.pairs.size(); ++first)
    for (std::size_t second = first + 1; second < anchors.pairs.size(); ++second) {
      if (!(is_met_exactly(first) && is_met_exactly(second))) continue;
      const auto i = static_cast<Eigen::Index>(first), j = static_cast<Eigen::Index>(second);
      const auto under = [&](const Similarity& map) -> ContradictingAnchors {
        const Vector3 arm = map.scale * (map.rotation * (sources.col(j) - sources.col(i)));
        return {first, second, arm.norm(), (targets.col(j) - targets.col(i) - arm).norm()};
      };
      const ContradictingAnchors pair = under(similarity);
      if (!(pair.source_distance < reach && contradicts(pair))) continue;
      const std::optional<Similarity> around = similarity_around(sources, targets, i, j);
      if (!around || contradicts(under(*around))) found.push_back(pair);
    }
  std::stable_sort(found.begin(), found.end(),
                   [](const ContradictingAnchors& a, const ContradictingAnchors& b) {
                     return a.target_difference * b.source_distance > b.target_difference * a.source_distance;
                   });
  return found;
}

std::string to_string(const std::vector<ContradictingAnchors>& contradicting, const Anchors& anchors) {
  constexpr std::size_t max_named = 5;
  std::string text;
  for (std::size_t k = 0; k < std::min(contradicting.size(), max_named); ++k) {
    const ContradictingAnchors& pair = contradicting[k];
    char distances[120];
    std::snprintf(distances, sizeof distances, " (%.3g apart, targets off by %.3g)", pair.source_distance,
                  pair.target_difference);
    text += (text.empty() ? "anchors " : "; ") + label(anchors, pair.first) + " and " +
            label(anchors, pair.second) + distances;
  }
  if (contradicting.size() > max_named)
    text += " and " + std::to_string(contradicting.size() - max_named) + " more";
  if (!text.empty()) text += " contradict each other; give those that are not exact a sigma";
  return text;
}

}  // namespace bespoke
