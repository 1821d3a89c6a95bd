#pragma once

#include "anatomy.h"

namespace bespoke {

/// Factors of a head's measures; 1 is the first head.
struct HeadBuild {
  double width = 1;
  double length = 1;  ///< front to back
  double face = 1;    ///< height of the face below the brow
  double nose = 1;    ///< projection
  double ears = 1;
  double jaw = 1;  ///< width
};

/// Skull and face, without ears, about the origin (midway between the ears), chin near y = -10.6, crown near
/// y = 11.5; no neck.
Solid skull(const HeadBuild& build);

/// A display head: skull, ears, neck and a foot cut flat at y = -19.
Anatomy display_head(const HeadBuild& build);

}  // namespace bespoke
