#pragma once

#include <vector>

#include "bespoke/surface_fit/detail/detail_layers.h"

namespace bespoke {

/// A surface whose exact anchors have been met as far as that does not stretch it too much.
struct AnchorMeeting {
  Points vertices;                ///< 3×n, diagonals
  Eigen::VectorXd anchor_sigmas;  ///< k, diagonals: 0 for anchors that are met, else how far they gave way
};

/// meet_anchors, but where it stretches or squeezes a face against `coarse` (3×n) beyond the factor
/// `max_stretch`, and more than it was, the anchors around give way: their σ grows, twofold each time, and
/// they are met as the smoothing of all moves by these accuracies has them (kriging with noise), until no
/// such face is left; likewise where some are missed since the moves of neighbours differ by more than a
/// layer's gradient allows. So two contradicting anchors share their residual.
AnchorMeeting meet_anchors_within(const DetailInput& input, const Points& coarse, double max_stretch,
                                  const DetailSettings& settings = {});

}  // namespace bespoke
