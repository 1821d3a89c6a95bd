#include "bespoke/rigid/similarity_alignment.h"

#include "bespoke/error.h"
#include "bespoke/rigid/nearest_rotation.h"

namespace bespoke {

// Umeyama 1991.
Similarity align_similarly(const Points& source, const Points& target, const Eigen::VectorXd& weights) {
  const double total = weights.sum();
  const Vector3 source_mean = source * weights / total, target_mean = target * weights / total;
  const Points x = source.colwise() - source_mean, y = target.colwise() - target_mean;
  const double spread = (x.colwise().squaredNorm() * weights).value();
  if (!(spread > 0)) throw InvalidInput("a similarity needs source points that do not coincide");
  const NearestRotation nearest = nearest_rotation(y * weights.asDiagonal() * x.transpose());
  Similarity result;
  result.rotation = nearest.rotation;
  result.scale = nearest.trace / spread;
  if (!(result.scale > 0)) throw InvalidInput("a similarity needs target points that do not coincide");
  result.translation = target_mean - result.scale * (result.rotation * source_mean);
  return result;
}

}  // namespace bespoke
