#include "bespoke/certificate/inverse.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

#include "bespoke/certificate/detail/cell_search.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Of the finest voxel.
constexpr double relative_tolerance = 1e-6;
// Newton converges in three to six steps where it does.
constexpr int largest_number_of_steps = 40;
constexpr double smallest_step = 1.0 / 64;
constexpr std::size_t points_per_batch = 1 << 17;

// Points on their way to their preimage; what is done leaves the batch.
struct Walk {
  std::vector<Eigen::Index> column;  // in the batch
  Points x, direction;
  Eigen::VectorXd residual, step;

  void keep(const std::vector<Eigen::Index>& kept) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
      const auto to = static_cast<Eigen::Index>(i);
      column[i] = column[static_cast<std::size_t>(kept[i])];
      x.col(to) = Vector3(x.col(kept[i]));
      direction.col(to) = Vector3(direction.col(kept[i]));
      residual[to] = residual[kept[i]];
      step[to] = step[kept[i]];
    }
    const auto size = static_cast<Eigen::Index>(kept.size());
    column.resize(kept.size());
    x.conservativeResize(3, size);
    direction.conservativeResize(3, size);
    residual.conservativeResize(size);
    step.conservativeResize(size);
  }
};

[[noreturn]] void refuse(const Vector3& y, double residual) {
  std::ostringstream message;
  message << "no preimage found for (" << y.transpose() << "), residual " << residual
          << "; is the map certified as a bijection?";
  throw SolverError(message.str());
}

}  // namespace

struct PointwiseInverse::Cells {
  explicit Cells(const BakedMap& map) : search(map) {}
  CellSearch search;
};

PointwiseInverse::PointwiseInverse(const BakedMap& map)
    : map_(map),
      inverse_linear_(inverse(map.affine()).linear),
      tolerance_(map.pyramid().levels.empty() ? 0
                                              : relative_tolerance * map.pyramid().levels.back().voxel_size),
      cells_(std::make_unique<const Cells>(map)) {}

PointwiseInverse::~PointwiseInverse() = default;

Points PointwiseInverse::operator()(const Points& y) const {
  if (!y.allFinite()) throw InvalidInput("a point to map back is not finite");
  // Where u vanishes at the affine preimage, that is the preimage, exactly.
  Points result = inverse_linear_ * (y.colwise() - map_.affine().offset);
  for (Eigen::Index first = 0; first < y.cols(); first += points_per_batch) {
    const Eigen::Index count = std::min<Eigen::Index>(points_per_batch, y.cols() - first);
    const Points start = result.middleCols(first, count);
    const Points u = map_.displacement(start);
    Walk walk;
    for (Eigen::Index i = 0; i < count; ++i)
      if (!u.col(i).isZero(0)) walk.column.push_back(first + i);
    const auto active = static_cast<Eigen::Index>(walk.column.size());
    walk.x.resize(3, active);
    for (Eigen::Index i = 0; i < active; ++i)
      walk.x.col(i) = result.col(walk.column[static_cast<std::size_t>(i)]);
    walk.direction = Points::Zero(3, active);
    walk.residual = Eigen::VectorXd::Constant(active, std::numeric_limits<double>::infinity());
    walk.step = Eigen::VectorXd::Zero(active);

    std::vector<Eigen::Index> stalled;
    for (int round = 0; round < largest_number_of_steps && !walk.column.empty(); ++round) {
      const Points trial = walk.x + walk.direction * walk.step.asDiagonal();
      const Points image = map_(trial);
      const Points gradient = map_.displacement_gradient(trial);
      std::vector<std::uint8_t> state(walk.column.size());  // 0 goes on, 1 done, 2 stalled
      parallel_for(state.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i) {
          const Vector3 missing = y.col(walk.column[static_cast<std::size_t>(i)]) - image.col(i);
          const double residual = missing.norm();
          const double rounding = 64 * std::numeric_limits<double>::epsilon() * image.col(i).norm();
          if (residual <= std::max(tolerance_, rounding)) {
            walk.x.col(i) = trial.col(i);
            state[static_cast<std::size_t>(i)] = 1;
          } else if (residual < (1 - 1e-3 * walk.step[i]) * walk.residual[i]) {
            walk.x.col(i) = trial.col(i);
            walk.residual[i] = residual;
            walk.direction.col(i) =
                Matrix3(map_.affine().linear + gradient.middleCols<3>(3 * i)).inverse() * missing;
            walk.step[i] = 1;
          } else {
            walk.step[i] /= 2;
            if (!(walk.step[i] >= smallest_step)) state[static_cast<std::size_t>(i)] = 2;
          }
        }
      });
      std::vector<Eigen::Index> kept;
      for (std::size_t i = 0; i < state.size(); ++i) {
        const auto column = static_cast<Eigen::Index>(i);
        if (state[i] == 0) kept.push_back(column);
        if (state[i] == 1) result.col(walk.column[i]) = walk.x.col(column);
        if (state[i] == 2) stalled.push_back(walk.column[i]);
      }
      walk.keep(kept);
    }
    stalled.insert(stalled.end(), walk.column.begin(), walk.column.end());
    std::sort(stalled.begin(), stalled.end());
    std::vector<double> residuals(stalled.size());
    parallel_for(stalled.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vector3 wanted = y.col(stalled[i]);
        const std::optional<Vector3> found = cells_->search.find(wanted, tolerance_);
        if (found) result.col(stalled[i]) = *found;
        if (!found) residuals[i] = std::max(tolerance_, (map_(result.col(stalled[i])) - wanted).norm());
      }
    });
    for (std::size_t i = 0; i < stalled.size(); ++i)
      if (residuals[i] > 0) refuse(y.col(stalled[i]), residuals[i]);
  }
  return result;
}

InverseMap::InverseMap(const BakedMap& map, const RigidTransform& target_from_source)
    : map_(map), inverse_(map), target_from_source_(target_from_source) {}

AffineMap InverseMap::affine() const {
  return compose(as_affine(target_from_source_),
                 compose(inverse(map_.affine()), as_affine(inverse(target_from_source_))));
}

// Γ∘E⁻¹∘Γ⁻¹ less its affine part is R (x − x₀), x the preimage and x₀ the affine one: exactly zero where the
// inverse is affine.
Points InverseMap::displacement(const Points& x) const {
  const Points image = bespoke::inverse(target_from_source_) * x;
  const Matrix3 inverse_linear = inverse(map_.affine()).linear;
  const Points affine_preimage = inverse_linear * (image.colwise() - map_.affine().offset);
  return target_from_source_.rotation * (inverse_(image) - affine_preimage);
}

Points InverseMap::displacement_gradient(const Points& x) const {
  const Points preimage = inverse_(bespoke::inverse(target_from_source_) * x);
  Points gradient = map_.displacement_gradient(preimage);
  const Matrix3 inverse_linear = inverse(map_.affine()).linear;
  const Matrix3& rotation = target_from_source_.rotation;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Matrix3 jacobian = map_.affine().linear + gradient.middleCols<3>(3 * i);
    gradient.middleCols<3>(3 * i) = rotation * (jacobian.inverse() - inverse_linear) * rotation.transpose();
  }
  return gradient;
}

// x ↦ A⁻¹ (E(x) − a₀) is a bijection that leaves alone what lies outside the support of u, so it maps that
// support onto itself: seen from there, the inverse has the same one.
Support InverseMap::support() const {
  Support support = map_.support();
  support.frame =
      compose(support.frame, compose(inverse(map_.affine()), as_affine(inverse(target_from_source_))));
  return support;
}

ComposedMap::ComposedMap(const ElasticMap& b_from_a, const RigidTransform& rigid_b_from_a,
                         const ElasticMap& c_from_b)
    : b_from_a_(b_from_a), rigid_b_from_a_(rigid_b_from_a), c_from_b_(c_from_b) {}

AffineMap ComposedMap::affine() const {
  const AffineMap rigid = as_affine(rigid_b_from_a_);
  return compose(as_affine(inverse(rigid_b_from_a_)),
                 compose(c_from_b_.affine(), compose(rigid, b_from_a_.affine())));
}

Points ComposedMap::displacement(const Points& x) const {
  const Points first = b_from_a_.displacement(x);
  const Points in_b = rigid_b_from_a_ * Points(b_from_a_.affine() * x + first);
  const Matrix3& rotation = rigid_b_from_a_.rotation;
  return rotation.transpose() *
         (c_from_b_.affine().linear * (rotation * first) + c_from_b_.displacement(in_b));
}

Points ComposedMap::displacement_gradient(const Points& x) const {
  Points gradient = b_from_a_.displacement_gradient(x);
  const Points in_b = rigid_b_from_a_ * b_from_a_(x);
  const Points second = c_from_b_.displacement_gradient(in_b);
  const Matrix3& rotation = rigid_b_from_a_.rotation;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Matrix3 inner = gradient.middleCols<3>(3 * i);
    const Matrix3 outer = second.middleCols<3>(3 * i);
    gradient.middleCols<3>(3 * i) =
        rotation.transpose() * (c_from_b_.affine().linear * rotation * inner +
                                outer * rotation * (b_from_a_.affine().linear + inner));
  }
  return gradient;
}

// Outside the first support the first map is affine, so the second one's support is seen through that.
Support ComposedMap::support() const {
  Support support;
  const auto add = [&](const Support& part, const AffineMap& frame) {
    const AffineMap back = inverse(compose(part.frame, frame));
    const double stretch = Eigen::JacobiSVD<Matrix3>(back.linear).singularValues()[0];
    for (const BallCloud& cloud : part.clouds)
      support.clouds.push_back({back * cloud.centers, stretch * cloud.radius});
  };
  add(b_from_a_.support(), {});
  add(c_from_b_.support(), compose(as_affine(rigid_b_from_a_), b_from_a_.affine()));
  return support;
}

AffineMap compose(const AffineMap& outer, const AffineMap& inner) {
  return {outer.linear * inner.linear, outer.linear * inner.offset + outer.offset};
}

AffineMap inverse(const AffineMap& map) {
  const Matrix3 linear = map.linear.inverse();
  if (!(linear.allFinite() && map.offset.allFinite()))
    throw InvalidInput("the affine part of the map is singular: it has no inverse");
  return {linear, -(linear * map.offset)};
}

AffineMap as_affine(const RigidTransform& transform) { return {transform.rotation, transform.translation}; }

}  // namespace bespoke
