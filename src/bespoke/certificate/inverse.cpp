#include "bespoke/certificate/inverse.h"

#include <Eigen/LU>
#include <algorithm>
#include <optional>
#include <sstream>

#include "bespoke/certificate/detail/cell_search.h"
#include "bespoke/certificate/detail/newton_walk.h"
#include "bespoke/error.h"
#include "bespoke/mapping/affine_map.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

// Of the finest voxel.
constexpr double relative_tolerance = 1e-6;
constexpr Eigen::Index points_per_batch = 1 << 17;

[[noreturn]] void refuse(const Vector3& y, double residual) {
  std::ostringstream message;
  message << "no preimage found for (" << y.transpose() << "), residual " << residual
          << "; is the map certified as a bijection?";
  throw SolverError(message.str());
}

std::vector<Eigen::Index> columns_not_zero(const Points& u) {
  std::vector<Eigen::Index> columns;
  for (Eigen::Index i = 0; i < u.cols(); ++i)
    if (!u.col(i).isZero(0)) columns.push_back(i);
  return columns;
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
  Points x(3, y.cols());
  for (Eigen::Index first = 0; first < y.cols(); first += points_per_batch) {
    const Eigen::Index count = std::min(points_per_batch, y.cols() - first);
    x.middleCols(first, count) = preimages(y.middleCols(first, count));
  }
  return x;
}

Points PointwiseInverse::preimages(const Points& y) const {
  // Where u vanishes at the affine preimage, that is the preimage, exactly.
  Points x = inverse_linear_ * (y.colwise() - map_.affine().offset);
  const std::vector<Eigen::Index> moved = columns_not_zero(map_.displacement(x));
  const Points wanted = y(Eigen::all, moved);
  NewtonWalks walks = walk_to_preimages(map_, wanted, x(Eigen::all, moved), tolerance_);
  search_cells(wanted, walks.stalled, walks.x);
  x(Eigen::all, moved) = walks.x;
  return x;
}

void PointwiseInverse::search_cells(const Points& y, const std::vector<Eigen::Index>& columns,
                                    Points& x) const {
  std::vector<char> missing(columns.size());
  parallel_for(columns.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::optional<Vector3> found = cells_->search.find(y.col(columns[i]), tolerance_);
      if (found) x.col(columns[i]) = *found;
      missing[i] = !found;
    }
  });
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (missing[i]) refuse(y.col(columns[i]), (map_(x.col(columns[i])) - y.col(columns[i])).norm());
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
  const Points image = inverse(target_from_source_) * x;
  const Matrix3 inverse_linear = inverse(map_.affine()).linear;
  const Points affine_preimage = inverse_linear * (image.colwise() - map_.affine().offset);
  return target_from_source_.rotation * (inverse_(image) - affine_preimage);
}

Points InverseMap::displacement_gradient(const Points& x) const {
  const Points preimage = inverse_(inverse(target_from_source_) * x);
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

}  // namespace bespoke
