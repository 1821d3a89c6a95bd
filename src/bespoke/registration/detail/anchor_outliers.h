#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "bespoke/anchors/anchor_accuracy.h"
#include "bespoke/anchors/anchor_audit.h"
#include "bespoke/mesh/closest_point.h"

namespace bespoke {

/// Tests pairs on the source without a given σ or weight against a registration. `registered`: the source's
/// registered vertices, 3×n, target frame, mesh units.
class AnchorOutlierTest {
 public:
  /// estimated: `given`, perhaps with pairs of curves behind. What is referred to must outlive this.
  AnchorOutlierTest(const TriangleMesh& source, const TriangleMesh& target, const Anchors& given,
                    const EstimatedAnchors& estimated);

  /// Suspects: pairs that a registration with all of them misses, or matches only by a strain around them
  /// (surface_strain.h) as of a stretch to twice the length; half of that for pairs that the others
  /// contradict. Where these are more than a third, they do not separate a wrong pair from its neighbours,
  /// and those that the others contradict are left; none where these are more than a third too, or among
  /// fewer than seven pairs. Numbers among those given, ascending.
  std::vector<std::size_t> suspects(const Points& registered, const AnchorAudit& audit) const;

  /// Of these pairs, which must be tested ones, those that the registered source misses: they lie
  /// farther from where it has them than 4 % of the target's diagonal, and than four times their estimated σ.
  std::vector<RejectedAnchor> displaced_pairs(const Points& registered,
                                              const std::vector<std::size_t>& pairs) const;

  /// The audit without pairs on the source that the registered source meets, as displaced_pairs has it,
  /// straining it no more than such pairs may: there the surfaces explain what the pairs alone do not.
  AnchorAudit unexplained(AnchorAudit audit, const Points& registered) const;

 private:
  double distance(const Points& registered, std::size_t tested) const;
  bool is_matched(std::size_t tested, double distance) const;

  const TriangleMesh& source_;
  const Anchors& given_;
  double source_size_;     // the diagonal
  std::size_t count_ = 0;  // of the given pairs that the fit uses
  std::vector<std::size_t> tested_;
  std::vector<SurfacePoint> feet_;  // of the tested pairs' sources
  std::vector<double> limits_;      // how far these may be missed, mesh units
};

}  // namespace bespoke
