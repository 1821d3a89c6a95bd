#include "bespoke/anchor_checks/stretching_anchors.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {
namespace {

struct Contradiction {
  std::size_t first, second;
  double difference;  // of distances, mesh units on the target
};

}  // namespace

std::vector<double> sigmas_within_stretch(const Anchors& anchors, std::size_t count, double max_stretch) {
  constexpr std::size_t min_pairs = 4;  // fewer tell no size
  // Of the targets' diagonal: two places, each accurate to anchor_resolution in every coordinate.
  constexpr double explained = std::numbers::sqrt2 * std::numbers::sqrt3 * 1e-3;
  std::vector<double> sigmas(count, 0);
  const Points sources = source_points(anchors), targets = target_points(anchors);
  if (anchors.pairs.size() < min_pairs || !(diagonal(sources) > 0) || !(diagonal(targets) > 0)) return sigmas;
  const double size = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols())).scale;
  const double noise = explained * diagonal(targets);
  std::vector<Contradiction> found;
  std::vector<std::size_t> contradicted(count, 0);
  std::size_t exact = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_exact(anchors.pairs[i])) continue;
    ++exact;
    for (std::size_t j = i + 1; j < count; ++j) {
      if (!is_exact(anchors.pairs[j])) continue;
      const double apart = size * (anchors.pairs[j].a - anchors.pairs[i].a).norm();
      const double on_target = (anchors.pairs[j].b - anchors.pairs[i].b).norm();
      const double difference = std::abs(on_target - apart);
      const bool stretches = std::max(apart, on_target) > max_stretch * std::min(apart, on_target);
      if (!(difference > noise && stretches)) continue;
      found.push_back({i, j, difference});
      ++contradicted[i];
      ++contradicted[j];
    }
  }
  const auto is_astray = [&](std::size_t i) { return 2 * contradicted[i] >= exact; };
  for (const Contradiction& pair : found) {
    if (is_astray(pair.first) || is_astray(pair.second)) continue;
    sigmas[pair.first] = std::max(sigmas[pair.first], pair.difference / 2);
    sigmas[pair.second] = std::max(sigmas[pair.second], pair.difference / 2);
  }
  return sigmas;
}

void let_contradicting_share(EstimatedAnchors& estimated, std::size_t given, double max_stretch) {
  const auto kept = static_cast<std::size_t>(
      std::lower_bound(estimated.kept.begin(), estimated.kept.end(), given) - estimated.kept.begin());
  const std::vector<double> sigmas = sigmas_within_stretch(estimated.anchors, kept, max_stretch);
  for (std::size_t k = 0; k < kept; ++k) {
    if (!(sigmas[k] > 0)) continue;
    estimated.anchors.pairs[k].sigma = sigmas[k];
    estimated.sigmas[estimated.kept[k]] = sigmas[k];
    estimated.accuracy.given_way.push_back({estimated.kept[k], sigmas[k]});
  }
}

}  // namespace bespoke
