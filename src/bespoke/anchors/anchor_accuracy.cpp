#include "bespoke/anchors/anchor_accuracy.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "bespoke/anchors/size_ratio.h"
#include "bespoke/length.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/statistics.h"

namespace bespoke {
namespace {

constexpr double inlier_sigmas = 3;          // farther ones do not shape the estimate: 0.3 % of normal errors
constexpr double outlier_sigmas = 4;         // 1 in 16,000 of normal errors
constexpr double median_of_normal = 0.6745;  // of |x|, in standard deviations
// Of the target's diagonal: points at random in the bounding boxes of the twelve shared targets (bodies,
// heads, hands, a foot) come to a σ of 8 to 16 %.
constexpr double of_chance = 0.08;

/// How much farther each pair of the surface without a given σ lies off the target than off the source, were
/// that `size_scale` times as large.
std::vector<OutlierAnchor> offsets(const Anchors& anchors, const TriangleMesh& source,
                                   const TriangleMesh& target, double size_scale) {
  const double reach = near_surface * diagonal(source.vertices);
  const ClosestPointTree source_surface(source), target_surface(target);
  std::vector<OutlierAnchor> all;
  for (std::size_t i = 0; i < anchors.pairs.size(); ++i) {
    const AnchorPair& pair = anchors.pairs[i];
    if (!has_no_given_sigma(pair)) continue;
    const auto on_source = source_surface.closest(pair.a, {.max_distance = reach});
    if (!on_source) continue;
    const double distance = std::sqrt(target_surface.closest(pair.b)->squared_distance);
    all.push_back({i, std::abs(distance - size_scale * std::sqrt(on_source->squared_distance))});
  }
  return all;
}

/// The standard deviation of normal errors with these absolute values, robust against a few outliers: trimmed
/// by the median absolute deviation (Hampel 1974).
double robust_deviation(const std::vector<OutlierAnchor>& offsets) {
  std::vector<double> distances;
  for (const OutlierAnchor& offset : offsets) distances.push_back(offset.distance);
  const double limit = inlier_sigmas * summarize(distances).median / median_of_normal;
  std::erase_if(distances, [&](double distance) { return distance > limit; });
  double squares = 0;
  for (const double distance : distances) squares += distance * distance;
  return distances.empty() ? 0 : std::sqrt(squares / double(distances.size()));
}

/// Takes pairs, by their numbers among those given, out of what the fit uses.
void drop(EstimatedAnchors& estimated, const std::vector<std::size_t>& dropped) {
  std::vector<AnchorPair> pairs;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < estimated.kept.size(); ++k) {
    if (std::find(dropped.begin(), dropped.end(), estimated.kept[k]) != dropped.end()) continue;
    pairs.push_back(std::move(estimated.anchors.pairs[k]));
    kept.push_back(estimated.kept[k]);
  }
  estimated.anchors.pairs = std::move(pairs);
  estimated.kept = std::move(kept);
}

}  // namespace

EstimatedAnchors estimate_anchor_sigmas(const Anchors& anchors, const TriangleMesh& source,
                                        const TriangleMesh& target) {
  EstimatedAnchors estimated{anchors, std::vector<std::size_t>(anchors.pairs.size()), {}, {}};
  std::iota(estimated.kept.begin(), estimated.kept.end(), 0);
  AnchorAccuracy& accuracy = estimated.accuracy;
  accuracy.swapped = swapped_anchors(anchors);
  // A pair with a given σ is no suspect.
  std::erase_if(accuracy.swapped, [&](const SwappedAnchors& pair) {
    return !(has_no_given_sigma(anchors.pairs[pair.first]) && has_no_given_sigma(anchors.pairs[pair.second]));
  });
  const double size_scale = power_of_two_scale(size_ratio(anchors, source, target));
  const double least = anchor_resolution * size_scale * diagonal(source.vertices);
  const std::vector<OutlierAnchor> off = offsets(anchors, source, target, size_scale);
  if (!off.empty()) {
    const double deviation = robust_deviation(off);
    accuracy.estimated = off.size();
    accuracy.sigma = deviation < least ? 0 : deviation;
    const double unit = std::max(deviation, least);
    for (const OutlierAnchor& offset : off) {
      estimated.anchors.pairs[offset.index].sigma =
          offset.distance > inlier_sigmas * unit ? offset.distance : accuracy.sigma;
      if (offset.distance > outlier_sigmas * unit) accuracy.outliers.push_back(offset);
    }
  }
  for (AnchorPair& pair : estimated.anchors.pairs)
    if (has_no_given_sigma(pair)) pair.sigma = 0;
  for (const AnchorPair& pair : estimated.anchors.pairs) estimated.sigmas.push_back(pair.sigma.value_or(0));
  for (const SwappedAnchors& pair : accuracy.swapped) {
    estimated.sigmas[pair.first] = estimated.sigmas[pair.second] =
        (anchors.pairs[pair.first].b - anchors.pairs[pair.second].b).norm();
    drop(estimated, {pair.first, pair.second});
  }
  return estimated;
}

EstimatedAnchors without(EstimatedAnchors estimated, const std::vector<RejectedAnchor>& left_out) {
  for (const RejectedAnchor& anchor : left_out) {
    estimated.sigmas[anchor.index] = anchor.distance;
    estimated.accuracy.left_out.push_back(anchor);
    std::erase_if(estimated.accuracy.outliers,
                  [&](const OutlierAnchor& outlier) { return outlier.index == anchor.index; });
    drop(estimated, {anchor.index});
  }
  return estimated;
}

std::string off_target(const AnchorAccuracy& accuracy, const TriangleMesh& target) {
  const double share = accuracy.sigma / diagonal(target.vertices);
  if (!(share > of_chance)) return "";
  char text[320];
  std::snprintf(
      text, sizeof text,
      "the anchors lie beside the target by %.4g (root mean square), %.3g %% of its diagonal, as points at "
      "random would: is it the right target, all of it, and is everything in one unit, with the same axes? "
      "Anchors meant so need an accuracy (sigma)",
      accuracy.sigma, 100 * share);
  return text;
}

std::string to_string(const AnchorAccuracy& accuracy, const Anchors& anchors) {
  std::string text;
  char number[120];
  if (accuracy.sigma > 0) {
    std::snprintf(number, sizeof number, "%zu anchors without an accuracy: sigma %.4g estimated",
                  accuracy.estimated, accuracy.sigma);
    text = number;
  }
  for (const OutlierAnchor& outlier : accuracy.outliers) {
    std::snprintf(number, sizeof number, " lies %.4g beside the target and hardly pulls", outlier.distance);
    text += (text.empty() ? "anchor " : "; anchor ") + label(anchors, outlier.index) + number;
  }
  for (const RejectedAnchor& anchor : accuracy.left_out) {
    std::snprintf(number, sizeof number, " lies %.4g from where the surfaces put it and is left out",
                  anchor.distance);
    text += (text.empty() ? "anchor " : "; anchor ") + label(anchors, anchor.index) + number;
  }
  for (const GivenWayAnchor& anchor : accuracy.given_way) {
    std::snprintf(number, sizeof number,
                  " gave way (sigma %.4g), since meeting it would stretch the surface too much",
                  anchor.sigma);
    text += (text.empty() ? "anchor " : "; anchor ") + label(anchors, anchor.index) + number;
  }
  if (!accuracy.swapped.empty())
    text += (text.empty() ? "" : "; ") + to_string(accuracy.swapped, anchors) + " and are left out";
  return text;
}

}  // namespace bespoke
