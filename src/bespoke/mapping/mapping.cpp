#include "bespoke/mapping/mapping.h"

#include <cmath>
#include <string>

#include "bespoke/error.h"

namespace bespoke {

namespace {

void require_finite(double t) {
  if (!std::isfinite(t)) throw InvalidInput("mapping at t = " + std::to_string(t) + ": t must be finite");
}

/// R(t) x + t T.
Points rigidly_moved(const Points& x, const RigidTransform& target_from_source, double t, RotationPath path) {
  const Matrix3 rotation = rotation_at(target_from_source.rotation, path, t);
  return (rotation * x).colwise() + t * target_from_source.translation;
}

}  // namespace

Points elastic_argument(const Points& x, const RigidTransform& target_from_source, double t,
                        const MotionOptions& options) {
  require_finite(t);
  if (options.order != MappingOrder::moving_point || t == 0 || t == 1) return x;
  return inverse(target_from_source) * rigidly_moved(x, target_from_source, t, options.path);
}

Points move_points(const Points& x, const Points& elastic_image, const RigidTransform& target_from_source,
                   double t, const MotionOptions& options) {
  if (x.cols() != elastic_image.cols())
    throw InvalidInput("mapping of " + std::to_string(x.cols()) + " points with " +
                       std::to_string(elastic_image.cols()) + " elastic images; the numbers must be equal");
  require_finite(t);
  // Exact at both ends, where the formulas below are only so up to rounding.
  if (t == 0) return x;
  if (t == 1) return target_from_source * elastic_image;

  const Vector3 translation = t * target_from_source.translation;
  switch (options.order) {
    // Eq. 1.
    case MappingOrder::elastic_first: {
      const Matrix3 rotation = rotation_at(target_from_source.rotation, options.path, t);
      return (rotation * ((1 - t) * x + t * elastic_image)).colwise() + translation;
    }
    // Fig. 4.
    case MappingOrder::rigid_first: {
      const Matrix3 rotation = rotation_at(target_from_source.rotation, options.path, t);
      const Matrix3 elastic_rotation = t * target_from_source.rotation;
      return (rotation * x + elastic_rotation * (elastic_image - x)).colwise() + translation;
    }
    // Eq. 19.
    case MappingOrder::moving_point:
      return (1 - t) * rigidly_moved(x, target_from_source, t, options.path) +
             t * (target_from_source * elastic_image);
    case MappingOrder::linear:
      return ((1 - t) * x + t * (target_from_source.rotation * elastic_image)).colwise() + translation;
  }
  throw InvalidInput("mapping: unknown order");
}

}  // namespace bespoke
