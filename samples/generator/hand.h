#pragma once

#include "anatomy.h"

namespace bespoke {

/// Factors of a hand's measures; 1 is the first hand.
struct HandBuild {
  double palm_length = 1;
  double palm_width = 1;
  double finger_length = 1;
  double thickness = 1;  ///< of fingers and palm
  double spread = 1;     ///< angle between the fingers
};

/// A left hand, palm to the front, fingers up, wrist at the origin, forearm cut flat at y = -8.
Anatomy hand(const HandBuild& build);

}  // namespace bespoke
