#pragma once

#include <span>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/progress.h"

namespace bespoke {

/// The points of one product where the caller keeps them: three doubles a point, mesh units. `x` and `image`
/// may be the same memory, else they do not overlap.
struct PointSpans {
  std::span<const double> x;
  std::span<double> image;
};

struct ApplyPointsOptions {
  double t = 1;
  MotionOptions motion;
  Progress progress;
};

/// Writes Ψ(t) of each product's points, as apply_mapping computes it, to where the caller wants it, a few
/// thousand points a thread at a time. All products are one stream, so many small ones cost no more than one
/// large one. Thread-safe over a shared `elastic`, with the same bytes. Throws InvalidInput for sizes that
/// differ or are no multiple of three and for a point that is not finite, naming product and point, and
/// Interrupted; what was written so far remains.
ApplySummary apply_points(const ElasticMap& elastic, const RigidTransform& target_from_source,
                          std::span<const PointSpans> products, const ApplyPointsOptions& options = {});

/// The same of one product.
ApplySummary apply_points(const ElasticMap& elastic, const RigidTransform& target_from_source,
                          const PointSpans& product, const ApplyPointsOptions& options = {});

}  // namespace bespoke
