#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchors.h"

namespace bespoke {

/// A pair that the others contradict.
struct SuspiciousAnchor {
  std::size_t index = 0;
  std::string name;
  double distance = 0;  ///< between its target and where the trusted pairs put its source, mesh units
  std::optional<std::size_t>
      swapped_with;  ///< the pair whose target fits it instead, and the other way round
};

struct AnchorAudit {
  std::vector<SuspiciousAnchor> suspicious;  ///< by decreasing distance
  /// Median over the trusted pairs, each predicted by the others, mesh units; none where they are too few.
  std::optional<double> typical_distance;
};

/// Leave-one-out audit: each pair is predicted by a smooth warp (biharmonic spline with an affine tail) of
/// the others; the worst is set aside until none lies farther off than four typical distances and 4 % of the
/// diagonal of the targets left. At most a third of the pairs is set aside. Fewer than 8 pairs cannot be
/// audited: nothing is suspicious then. Throws InvalidInput for values that are not finite.
AnchorAudit audit_anchors(const Anchors& anchors);

/// One line, empty without suspicion: every suspicious pair, how far off it is, what it may be swapped with.
std::string to_string(const AnchorAudit& audit, const Anchors& anchors);

}  // namespace bespoke
