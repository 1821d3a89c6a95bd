#include "bespoke/registration/detail/anchor_outliers.h"

#include <algorithm>
#include <numbers>

#include "bespoke/quality/surface_strain.h"

namespace bespoke {
namespace {

// Of the target's diagonal: farther from it a pair is not met (tests/accuracy/tuning.md).
constexpr double unmet = 0.04;
// Of the pair's σ, if that is more: an inaccurate pair is not met anyway.
constexpr double unmet_sigmas = 4;

// Logarithmic, around an anchor: twofold. Correct anchors cause less, displaced ones more
// (tests/accuracy/tuning.md).
constexpr double max_strain = std::numbers::ln2;
constexpr double max_strain_of_contradicted = max_strain / 2;

constexpr std::size_t min_trusted = 6;  // hold a pose

}  // namespace

AnchorOutlierTest::AnchorOutlierTest(const TriangleMesh& source, const TriangleMesh& target,
                                     const Anchors& given, const EstimatedAnchors& estimated)
    : source_(source), given_(given), source_size_(diagonal(source.vertices)) {
  const double min_limit = unmet * diagonal(target.vertices);
  const ClosestPointTree surface(source);
  for (const std::size_t pair : estimated.kept) {
    if (pair >= given.pairs.size()) break;  // those of curves
    ++count_;
    if (!has_no_given_sigma(given.pairs[pair])) continue;
    const std::optional<SurfacePoint> foot =
        surface.closest(given.pairs[pair].a, {.max_distance = near_surface * source_size_});
    if (!foot) continue;
    tested_.push_back(pair);
    feet_.push_back(*foot);
    limits_.push_back(std::max(min_limit, unmet_sigmas * estimated.sigmas[pair]));
  }
}

std::vector<std::size_t> AnchorOutlierTest::suspects(const Points& registered,
                                                     const AnchorAudit& audit) const {
  const Eigen::VectorXd strains = strain_around(source_, registered, feet_, near_surface * source_size_);
  std::vector<std::size_t> all, contradicted;
  for (std::size_t k = 0; k < tested_.size(); ++k) {
    const std::size_t pair = tested_[k];
    const bool is_contradicted =
        std::any_of(audit.suspicious.begin(), audit.suspicious.end(),
                    [&](const SuspiciousAnchor& anchor) { return anchor.index == pair; });
    const double most = is_contradicted ? max_strain_of_contradicted : max_strain;
    if (is_matched(k, distance(registered, k)) && !(strains[static_cast<Eigen::Index>(k)] > most)) continue;
    all.push_back(pair);
    if (is_contradicted) contradicted.push_back(pair);
  }
  const std::size_t spared = count_ - std::min(count_, std::max(count_ - count_ / 3, min_trusted));
  if (all.size() <= spared) return all;
  return contradicted.size() <= spared ? contradicted : std::vector<std::size_t>();
}

std::vector<RejectedAnchor> AnchorOutlierTest::displaced_pairs(const Points& registered,
                                                               const std::vector<std::size_t>& pairs) const {
  std::vector<RejectedAnchor> displaced;
  for (const std::size_t pair : pairs) {
    const auto k =
        static_cast<std::size_t>(std::lower_bound(tested_.begin(), tested_.end(), pair) - tested_.begin());
    const double off = distance(registered, k);
    if (!is_matched(k, off)) displaced.push_back({pair, off});
  }
  return displaced;
}

AnchorAudit AnchorOutlierTest::unexplained(AnchorAudit audit, const Points& registered) const {
  if (audit.suspicious.empty()) return audit;
  const Eigen::VectorXd strains = strain_around(source_, registered, feet_, near_surface * source_size_);
  std::erase_if(audit.suspicious, [&](const SuspiciousAnchor& anchor) {
    const auto found = std::lower_bound(tested_.begin(), tested_.end(), anchor.index);
    if (found == tested_.end() || *found != anchor.index) return false;
    const auto k = static_cast<std::size_t>(found - tested_.begin());
    return is_matched(k, distance(registered, k)) &&
           !(strains[static_cast<Eigen::Index>(k)] > max_strain_of_contradicted);
  });
  return audit;
}

double AnchorOutlierTest::distance(const Points& registered, std::size_t tested) const {
  return (carried(feet_[tested], source_.faces, registered) - given_.pairs[tested_[tested]].b).norm();
}

bool AnchorOutlierTest::is_matched(std::size_t tested, double distance) const {
  return distance <= limits_[tested];
}

}  // namespace bespoke
