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

constexpr double resolution = 1e-3;          // of the source's diagonal, as large as the target: the least σ
constexpr double inlier_sigmas = 3;          // farther ones do not shape the estimate: 0.3 % of normal errors
constexpr double slipped_sigmas = 4;         // 1 in 16,000 of normal errors
constexpr double median_of_normal = 0.6745;  // of |x|, in standard deviations
// Of the target's diagonal: points at random in the bounding boxes of the twelve shared targets (bodies,
// heads, hands, a foot) come to a σ of 8 to 16 %.
constexpr double of_chance = 0.08;

/// How far each unrated pair of the surface lies off the target beyond what it lies off the source, were that
/// `octave` times as large.
std::vector<SlippedAnchor> offsets(const Anchors& anchors, const TriangleMesh& source,
                                   const TriangleMesh& target, double octave) {
  const double reach = near_surface * diagonal(source.vertices);
  const ClosestPointTree source_surface(source), target_surface(target);
  std::vector<SlippedAnchor> all;
  for (std::size_t i = 0; i < anchors.pairs.size(); ++i) {
    const AnchorPair& pair = anchors.pairs[i];
    if (!is_unrated(pair)) continue;
    const auto on_source = source_surface.closest(pair.a, {.max_distance = reach});
    if (!on_source) continue;
    const double distance = std::sqrt(target_surface.closest(pair.b)->squared_distance);
    all.push_back({i, std::abs(distance - octave * std::sqrt(on_source->squared_distance))});
  }
  return all;
}

/// The standard deviation of normal errors with these absolute values, robust against a few that are not.
double robust_deviation(const std::vector<SlippedAnchor>& offsets) {
  std::vector<double> distances;
  for (const SlippedAnchor& offset : offsets) distances.push_back(offset.distance);
  const double limit = inlier_sigmas * summarize(distances).median / median_of_normal;
  std::erase_if(distances, [&](double distance) { return distance > limit; });
  double squares = 0;
  for (const double distance : distances) squares += distance * distance;
  return distances.empty() ? 0 : std::sqrt(squares / double(distances.size()));
}

/// Takes pairs, by their numbers among those given, out of what the fit uses.
void drop(RatedAnchors& rated, const std::vector<std::size_t>& dropped) {
  std::vector<AnchorPair> pairs;
  std::vector<std::size_t> kept;
  for (std::size_t k = 0; k < rated.kept.size(); ++k) {
    if (std::find(dropped.begin(), dropped.end(), rated.kept[k]) != dropped.end()) continue;
    pairs.push_back(std::move(rated.anchors.pairs[k]));
    kept.push_back(rated.kept[k]);
  }
  rated.anchors.pairs = std::move(pairs);
  rated.kept = std::move(kept);
}

}  // namespace

RatedAnchors rate_anchors(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target) {
  RatedAnchors rated{anchors, std::vector<std::size_t>(anchors.pairs.size()), {}, {}};
  std::iota(rated.kept.begin(), rated.kept.end(), 0);
  AnchorAccuracy& accuracy = rated.accuracy;
  accuracy.swapped = swapped_anchors(anchors);
  // Who gives an accuracy stands by the pair.
  std::erase_if(accuracy.swapped, [&](const SwappedAnchors& pair) {
    return !(is_unrated(anchors.pairs[pair.first]) && is_unrated(anchors.pairs[pair.second]));
  });
  const double octave = octave_of(size_ratio(anchors, source, target));
  const double least = resolution * octave * diagonal(source.vertices);
  const std::vector<SlippedAnchor> off = offsets(anchors, source, target, octave);
  if (!off.empty()) {
    const double deviation = robust_deviation(off);
    accuracy.estimated = off.size();
    accuracy.sigma = deviation < least ? 0 : deviation;
    const double unit = std::max(deviation, least);
    for (const SlippedAnchor& offset : off) {
      rated.anchors.pairs[offset.index].sigma =
          offset.distance > inlier_sigmas * unit ? offset.distance : accuracy.sigma;
      if (offset.distance > slipped_sigmas * unit) accuracy.slipped.push_back(offset);
    }
  }
  for (AnchorPair& pair : rated.anchors.pairs)
    if (is_unrated(pair)) pair.sigma = 0;
  for (const AnchorPair& pair : rated.anchors.pairs) rated.sigmas.push_back(pair.sigma.value_or(0));
  for (const SwappedAnchors& pair : accuracy.swapped) {
    rated.sigmas[pair.first] = rated.sigmas[pair.second] =
        (anchors.pairs[pair.first].b - anchors.pairs[pair.second].b).norm();
    drop(rated, {pair.first, pair.second});
  }
  return rated;
}

RatedAnchors without(RatedAnchors rated, const std::vector<LeftOutAnchor>& left_out) {
  for (const LeftOutAnchor& anchor : left_out) {
    rated.sigmas[anchor.index] = anchor.distance;
    rated.accuracy.left_out.push_back(anchor);
    std::erase_if(rated.accuracy.slipped,
                  [&](const SlippedAnchor& slipped) { return slipped.index == anchor.index; });
    drop(rated, {anchor.index});
  }
  return rated;
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
  for (const SlippedAnchor& slipped : accuracy.slipped) {
    std::snprintf(number, sizeof number, " lies %.4g beside the target and hardly pulls", slipped.distance);
    text += (text.empty() ? "anchor " : "; anchor ") + label(anchors, slipped.index) + number;
  }
  for (const LeftOutAnchor& anchor : accuracy.left_out) {
    std::snprintf(number, sizeof number, " lies %.4g from where the surfaces put it and is left out",
                  anchor.distance);
    text += (text.empty() ? "anchor " : "; anchor ") + label(anchors, anchor.index) + number;
  }
  if (!accuracy.swapped.empty()) text += (text.empty() ? "" : "; ") + to_string(accuracy.swapped, anchors);
  return text;
}

}  // namespace bespoke
