#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "bespoke/mapping/mapping.h"

namespace bespoke {

struct ApplySummary {
  std::size_t points = 0;
  std::size_t in_band = 0;      ///< u(x) ≠ 0
  std::size_t affine_only = 0;  ///< u(x) = 0: the affine fallback
  double seconds = 0;           ///< of the lookups
};

/// One line.
std::string to_string(const ApplySummary& summary);

struct AppliedPoints {
  std::vector<Points> frames;  ///< Ψ(t) x, one per time
  ApplySummary summary;
};

/// Ψ(t) of the columns of x (3×n, source frame, mesh units) for every t, from one lookup of E (and one more
/// for every t between in the order of the moving point). On the path `flow` a chain of several steps goes
/// through them (ElasticChain::at). The result is in the target frame at t = 1. Throws InvalidInput for
/// non-finite points or times, naming the first.
AppliedPoints apply_mapping(const ElasticMap& elastic, const RigidTransform& target_from_source,
                            const Points& x, const std::vector<double>& times,
                            const MotionOptions& motion = {});

/// Where points go (3×n to 3×n).
using ImageOfPoints = std::function<Points(const Points& x)>;

/// The images of Ψ(t). `elastic` must outlive it.
ImageOfPoints image_at(const ElasticMap& elastic, const RigidTransform& target_from_source, double t,
                       const MotionOptions& motion = {});

}  // namespace bespoke
