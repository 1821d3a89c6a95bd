#pragma once

#include "anatomy.h"

namespace bespoke {

/// Factors of a foot's measures; 1 is the first foot.
struct FootBuild {
  double length = 1;
  double width = 1;
  double instep = 1;  ///< height
  double ankle = 1;   ///< thickness
};

/// Lofts run along y; this lays them along z, their front up.
Eigen::Affine3d lying();

/// A left foot flat on y = 0 with its toes in one, below the ankle; the shin's axis meets the origin.
Solid stockinged_foot(const FootBuild& build);

/// How far the foot is lifted off the ground z cm before the ankle: it stands as in a shoe with a heel.
double heel_lift(const FootBuild& build, double z);

/// A left foot, toes to the front, cut flat above the ankle; its ball rests on y = 0.
Anatomy foot(const FootBuild& build);

}  // namespace bespoke
