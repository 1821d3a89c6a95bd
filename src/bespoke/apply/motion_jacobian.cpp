#include "bespoke/apply/motion_jacobian.h"

#include <algorithm>
#include <cmath>

#include "bespoke/apply/detail/followed_chain.h"

namespace bespoke {
namespace {

/// a + b g for each of the 3×3 matrices g that stand side by side.
Points combined(const Matrix3& a, const Matrix3& b, const Points& gradients) {
  Points result = b * gradients;
  for (Eigen::Index i = 0; i < result.cols(); i += 3) result.middleCols<3>(i) += a;
  return result;
}

/// ∇E = A + ∇u.
Points elastic_gradient(const ElasticMap& elastic, const Points& x) {
  return combined(elastic.affine().linear, Matrix3::Identity(), elastic.displacement_gradient(x));
}

/// The Jacobian of ElasticChain::at: that of the whole steps, and a fraction of the next.
Points chain_gradient(const ElasticChain& chain, const Points& x, double t) {
  const auto count = static_cast<double>(chain.steps().size());
  const double last = std::clamp(std::floor(t * count), 0.0, count - 1);
  Points images = x;
  Points before = Matrix3::Identity().replicate(1, x.cols());
  for (double k = 0;; ++k) {
    const ElasticMap& step = *chain.steps()[static_cast<std::size_t>(k)];
    Points after = elastic_gradient(step, images);
    for (Eigen::Index i = 0; i < after.cols(); i += 3)
      after.middleCols<3>(i) = (after.middleCols<3>(i) * before.middleCols<3>(i)).eval();
    if (k == last) return (1 - (t * count - k)) * before + (t * count - k) * after;
    images = step(images);
    before = std::move(after);
  }
}

/// ∇Ψ(t) out of ∇E at the points that Ψ(t) requires; the formulas are those of move_points.
Points moved_gradient(const Points& gradient, const Matrix3& target_from_source, double t,
                      const MotionOptions& motion) {
  const Matrix3 identity = Matrix3::Identity();
  if (t == 1) return target_from_source * gradient;
  if (motion.order == MappingOrder::linear)
    return combined((1 - t) * identity, t * target_from_source, gradient);
  const Matrix3 rotation = rotation_at(target_from_source, motion.path, t);
  if (motion.order == MappingOrder::elastic_first)
    return combined((1 - t) * rotation, t * rotation, gradient);
  if (motion.order == MappingOrder::rigid_first)
    return combined(rotation - t * target_from_source, t * target_from_source, gradient);
  Points result(3, gradient.cols());
  for (Eigen::Index i = 0; i < result.cols(); i += 3) {
    const Matrix3 turned = target_from_source * gradient.middleCols<3>(i) * target_from_source.transpose();
    result.middleCols<3>(i) = ((1 - t) * identity + t * turned) * rotation;
  }
  return result;
}

}  // namespace

std::vector<Points> motion_jacobian(const ElasticMap& elastic, const RigidTransform& target_from_source,
                                    const Points& x, const std::vector<double>& times,
                                    const MotionOptions& motion) {
  const ElasticChain* const chain = followed_chain(elastic, motion);
  std::vector<Points> frames;
  Points at_rest;
  for (const double t : times) {
    if (t == 0) {
      frames.emplace_back(Matrix3::Identity().replicate(1, x.cols()));
    } else if (chain && t != 1) {
      frames.emplace_back(rotation_at(target_from_source.rotation, motion.path, t) *
                          chain_gradient(*chain, x, t));
    } else if (motion.order == MappingOrder::moving_point && t != 1) {
      const Points argument = elastic_argument(x, target_from_source, t, motion);
      frames.push_back(
          moved_gradient(elastic_gradient(elastic, argument), target_from_source.rotation, t, motion));
    } else {
      if (at_rest.cols() == 0) at_rest = elastic_gradient(elastic, x);
      frames.push_back(moved_gradient(at_rest, target_from_source.rotation, t, motion));
    }
  }
  return frames;
}

}  // namespace bespoke
