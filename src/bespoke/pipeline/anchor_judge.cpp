#include "bespoke/pipeline/anchor_judge.h"

#include <algorithm>
#include <numbers>

#include "bespoke/quality/surface_strain.h"

namespace bespoke {
namespace {

// Of the target's diagonal. Fifteen right pairs of each of five pairs of models, left out one by one, came to
// lie within 2.7 %; clicks that slipped by 15 % on ten, at 11.6 % or farther.
constexpr double unmet = 0.04;
// Of the pair's σ, if that is more: an inaccurate pair is not met anyway.
constexpr double unmet_sigmas = 4;

// Right pairs of 31 pairs of models: .63 at most, but for armpits of one body with its arms overhead, .93.
// Clicks that slipped by 15 %: 1.0 or more there or at a neighbour, but for fingers that bend with the click,
// .5, whose pairs the others contradict.
constexpr double most_strain = std::numbers::ln2;
constexpr double most_strain_of_contradicted = most_strain / 2;

constexpr std::size_t least_trusted = 6;  // hold a pose

}  // namespace

AnchorJudge::AnchorJudge(const TriangleMesh& source, const TriangleMesh& target, const Anchors& given,
                         const RatedAnchors& rated)
    : source_(source), given_(given), source_size_(diagonal(source.vertices)) {
  const double least_limit = unmet * diagonal(target.vertices);
  const ClosestPointTree surface(source);
  for (const std::size_t pair : rated.kept) {
    if (pair >= given.pairs.size()) break;  // those of curves
    ++count_;
    if (!is_unrated(given.pairs[pair])) continue;
    const std::optional<SurfacePoint> foot =
        surface.closest(given.pairs[pair].a, {.max_distance = near_surface * source_size_});
    if (!foot) continue;
    judged_.push_back(pair);
    feet_.push_back(*foot);
    limits_.push_back(std::max(least_limit, unmet_sigmas * rated.sigmas[pair]));
  }
}

std::vector<std::size_t> AnchorJudge::doubted(const Points& laid, const AnchorAudit& audit) const {
  const Eigen::VectorXd strains = strain_around(source_, laid, feet_, near_surface * source_size_);
  std::vector<std::size_t> all, contradicted;
  for (std::size_t k = 0; k < judged_.size(); ++k) {
    const std::size_t pair = judged_[k];
    const bool is_contradicted =
        std::any_of(audit.suspicious.begin(), audit.suspicious.end(),
                    [&](const SuspiciousAnchor& anchor) { return anchor.index == pair; });
    const double most = is_contradicted ? most_strain_of_contradicted : most_strain;
    if (is_met(k, distance(laid, k)) && !(strains[static_cast<Eigen::Index>(k)] > most)) continue;
    all.push_back(pair);
    if (is_contradicted) contradicted.push_back(pair);
  }
  const std::size_t spared = count_ - std::min(count_, std::max(count_ - count_ / 3, least_trusted));
  if (all.size() <= spared) return all;
  return contradicted.size() <= spared ? contradicted : std::vector<std::size_t>();
}

std::vector<LeftOutAnchor> AnchorJudge::put_elsewhere(const Points& laid,
                                                      const std::vector<std::size_t>& pairs) const {
  std::vector<LeftOutAnchor> elsewhere;
  for (const std::size_t pair : pairs) {
    const auto k =
        static_cast<std::size_t>(std::lower_bound(judged_.begin(), judged_.end(), pair) - judged_.begin());
    const double off = distance(laid, k);
    if (!is_met(k, off)) elsewhere.push_back({pair, off});
  }
  return elsewhere;
}

double AnchorJudge::distance(const Points& laid, std::size_t judged) const {
  return (carried(feet_[judged], source_.faces, laid) - given_.pairs[judged_[judged]].b).norm();
}

bool AnchorJudge::is_met(std::size_t judged, double distance) const { return distance <= limits_[judged]; }

}  // namespace bespoke
