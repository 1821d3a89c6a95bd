#include "bespoke/flow/regional_motion.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bespoke/flow/detail/face_gradients.h"
#include "bespoke/flow/detail/region_means.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {
namespace {

constexpr double degree = std::numbers::pi / 180;

// Up to here one elastic map does: the shared pairs of one pose reach 43° and factors of 1 / 0.49 and 2.02.
constexpr double turn_of_one_step = 60 * degree;
constexpr double stretch_of_one_step = 3;

// Beyond, per step: smaller steps take more of them, larger ones more voxels each.
constexpr double turn_per_step = 30 * degree;
constexpr double stretch_per_step = 1.5;

// Regions squeezed flat say nothing about the number of steps: none is enough.
constexpr double min_stretch = 0.1;

}  // namespace

RegionalMotion regional_motion(const TriangleMesh& source, const Points& fitted) {
  const FaceGradients gradients = face_gradients(source, fitted);
  const double whole = growth(source, fitted);
  RegionalMotion motion;
  for_each_region(
      source, gradients.areas, [&](Eigen::Index face) { return gradients.of(face); },
      [&](const Matrix3& mean) {
        motion.turn = std::max(motion.turn, Eigen::AngleAxisd(nearest_rotation(mean).rotation).angle());
        const Vector3 factors = Eigen::JacobiSVD<Matrix3>(mean / whole).singularValues();
        motion.stretch = std::max({motion.stretch, factors[0], 1 / std::max(factors[2], min_stretch)});
      });
  return motion;
}

int step_count(const RegionalMotion& motion) {
  if (motion.turn <= turn_of_one_step && motion.stretch <= stretch_of_one_step) return 1;
  const double turns = motion.turn / turn_per_step;
  const double stretches =
      motion.stretch > stretch_of_one_step ? std::log(motion.stretch) / std::log(stretch_per_step) : 1;
  return static_cast<int>(std::ceil(std::max(turns, stretches)));
}

}  // namespace bespoke
