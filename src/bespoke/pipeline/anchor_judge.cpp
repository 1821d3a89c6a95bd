#include "bespoke/pipeline/anchor_judge.h"

#include <algorithm>
#include <limits>
#include <numbers>

#include "bespoke/quality/surface_strain.h"

namespace bespoke {
namespace {

// Of the target's diagonal. Fifteen right pairs of each of five pairs of models, left out one by one, came to
// lie within 2.7 %; clicks that slipped by 15 % on ten, at 11.6 % or farther.
constexpr double unmet = 0.04;

// Right pairs of 31 pairs of models: .63 at most, but for armpits of one body with its arms overhead, .93.
// Clicks that slipped by 15 %: 1.0 or more there or at a neighbour, but for fingers that bend with the click,
// .5, whose pairs the others contradict.
constexpr double most_strain = std::numbers::ln2;
constexpr double most_strain_of_contradicted = most_strain / 2;

constexpr std::size_t least_trusted = 6;  // hold a pose

}  // namespace

AnchorJudge::AnchorJudge(const TriangleMesh& source, const TriangleMesh& target, const Anchors& given,
                         const RatedAnchors& rated)
    : source_(source),
      given_(given),
      source_size_(diagonal(source.vertices)),
      target_size_(diagonal(target.vertices)) {
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
  }
}

std::vector<std::size_t> AnchorJudge::doubted(const Points& laid, const AnchorAudit& audit) const {
  struct Doubt {
    std::size_t pair;
    double strain;
  };
  const Eigen::VectorXd strains = strain_around(source_, laid, feet_, near_surface * source_size_);
  std::vector<Doubt> doubts;
  for (std::size_t k = 0; k < judged_.size(); ++k) {
    const std::size_t pair = judged_[k];
    const bool is_contradicted =
        std::any_of(audit.suspicious.begin(), audit.suspicious.end(),
                    [&](const SuspiciousAnchor& anchor) { return anchor.index == pair; });
    const double strain = strains[static_cast<Eigen::Index>(k)];
    if (!is_met(distance(laid, k)))
      doubts.push_back({pair, std::numeric_limits<double>::infinity()});
    else if (strain > (is_contradicted ? most_strain_of_contradicted : most_strain))
      doubts.push_back({pair, strain});
  }
  std::stable_sort(doubts.begin(), doubts.end(),
                   [](const Doubt& a, const Doubt& b) { return a.strain > b.strain; });
  const std::size_t trusted = std::max(count_ - count_ / 3, least_trusted);
  doubts.resize(std::min(doubts.size(), count_ - std::min(count_, trusted)));
  std::vector<std::size_t> pairs;
  for (const Doubt& doubt : doubts) pairs.push_back(doubt.pair);
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<LeftOutAnchor> AnchorJudge::put_elsewhere(const Points& laid,
                                                      const std::vector<std::size_t>& pairs) const {
  std::vector<LeftOutAnchor> elsewhere;
  for (const std::size_t pair : pairs) {
    const auto k = std::lower_bound(judged_.begin(), judged_.end(), pair) - judged_.begin();
    const double off = distance(laid, static_cast<std::size_t>(k));
    if (!is_met(off)) elsewhere.push_back({pair, off});
  }
  return elsewhere;
}

double AnchorJudge::distance(const Points& laid, std::size_t judged) const {
  const SurfacePoint& foot = feet_[judged];
  return (laid(Eigen::all, source_.faces.col(foot.face)) * foot.barycentric - given_.pairs[judged_[judged]].b)
      .norm();
}

bool AnchorJudge::is_met(double distance) const { return distance <= unmet * target_size_; }

}  // namespace bespoke
