#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "bespoke/pattern/piece.h"

namespace bespoke {

/// What flat cloth must do to take a piece's shape: principal stretches of the map from the flat piece to the
/// surface, 1 where it does nothing. Percentiles by area.
struct ClothStrain {
  double min = 1, p5 = 1, p95 = 1, max = 1;  ///< both stretches of all faces
  double strain_p95 = 0;                     ///< of a face's larger |stretch − 1|
  double area_change = 0;                    ///< the surface's area over the flat one, minus 1
  Eigen::VectorXd of_face;                   ///< m: the larger |stretch − 1|
};

/// flat: 2×n, millimetres, without flipped faces.
ClothStrain cloth_strain(const Piece& piece, const Eigen::Matrix2Xd& flat);

/// "stretch 0.98 … 1.03 (p5 0.99, p95 1.01), area +0.2 %".
std::string to_string(const ClothStrain& strain);

/// How far cloth stretches along its grain (warp) and across it (weft), fractions.
struct StretchLimits {
  double warp = 0, weft = 0;
};

/// Where cloth would have to stretch more.
struct StretchExcess {
  double area_share = 0;              ///< of the surface
  double warp_max = 0, weft_max = 0;  ///< largest stretch minus 1
};

/// grain: unit vector in the plane.
StretchExcess stretch_beyond(const Piece& piece, const Eigen::Matrix2Xd& flat, const Eigen::Vector2d& grain,
                             const StretchLimits& limits);

}  // namespace bespoke
