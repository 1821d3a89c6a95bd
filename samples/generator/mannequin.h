#pragma once

#include "anatomy.h"

namespace bespoke {

/// Of the figure that all lengths are given for, centimetres.
inline constexpr double standard_height = 165;

/// A display mannequin with arms held away from the body. Girth factors are about 1.
struct MannequinBuild {
  double height = 165;  ///< cm
  double shoulders = 1;
  double bust = 1;
  double waist = 1;
  double hips = 1;
  double belly = 0;  ///< extra depth of the abdomen, cm
  double limbs = 1;  ///< thickness of arms and legs
  double breasts = 1;
};

Anatomy mannequin(const MannequinBuild& build);

/// Height of the widest hips, cm.
double hip_height(const MannequinBuild& build);

/// Girth at the hips, cm: length of the surface's outline there.
double hip_girth(const MannequinBuild& build, const Field& mannequin_field);

/// A mannequin whose hip girth is `girth` cm, other girths graded with it.
MannequinBuild graded_build(double height, double girth);

}  // namespace bespoke
