#include "bespoke/certificate/detail/newton_walk.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int largest_number_of_steps = 40;
constexpr double smallest_step = 1.0 / 64;
// A step of length s must reduce the residual by this share of s.
constexpr double min_reduction = 1e-3;
// Of an image's coordinates: what its sums and products may round, in units of the last place.
constexpr double image_rounding = 64 * std::numeric_limits<double>::epsilon();

enum class WalkState : char { goes_on, arrived, stalled };

struct Walker {
  Eigen::Index column;  // in y
  Vector3 x;            // the best place so far
  Vector3 direction = Vector3::Zero();
  double residual = std::numeric_limits<double>::infinity();  // at x
  double step = 0;                                            // along the direction, tried next
  WalkState state = WalkState::goes_on;

  Vector3 trial() const { return x + step * direction; }
};

struct Image {
  Vector3 value;
  Matrix3 jacobian;
};

// Damped Newton, x += s J⁻¹ (y − E(x)), with Armijo's condition on the residual.
// Accepts or refuses the walker's trial, whose image is known.
void advance(Walker& walker, const Image& image, const Vector3& y, double tolerance) {
  const Vector3 missing = y - image.value;
  const double residual = missing.norm();
  if (residual <= std::max(tolerance, image_rounding * image.value.norm())) {
    walker.x = walker.trial();
    walker.state = WalkState::arrived;
  } else if (residual < (1 - min_reduction * walker.step) * walker.residual) {
    walker.x = walker.trial();
    walker.residual = residual;
    walker.direction = image.jacobian.inverse() * missing;
    walker.step = 1;
  } else {
    walker.step /= 2;
    if (!(walker.step >= smallest_step)) walker.state = WalkState::stalled;
  }
}

void advance_all(std::vector<Walker>& walkers, const BakedMap& map, const Points& y, double tolerance) {
  Points trial(3, static_cast<Eigen::Index>(walkers.size()));
  for (std::size_t i = 0; i < walkers.size(); ++i)
    trial.col(static_cast<Eigen::Index>(i)) = walkers[i].trial();
  const Points image = map(trial);
  const Points gradient = map.displacement_gradient(trial);
  parallel_for(walkers.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Matrix3 jacobian = map.affine().linear + gradient.middleCols<3>(3 * column);
      advance(walkers[i], {image.col(column), jacobian}, y.col(walkers[i].column), tolerance);
    }
  });
}

}  // namespace

NewtonWalks walk_to_preimages(const BakedMap& map, const Points& y, const Points& start, double tolerance) {
  std::vector<Walker> walkers;
  for (Eigen::Index column = 0; column < y.cols(); ++column)
    walkers.push_back({.column = column, .x = start.col(column)});
  NewtonWalks result{start, {}};
  const auto collect = [&](const Walker& walker) {
    result.x.col(walker.column) = walker.x;
    if (walker.state != WalkState::arrived) result.stalled.push_back(walker.column);
  };
  for (int step = 0; step < largest_number_of_steps && !walkers.empty(); ++step) {
    advance_all(walkers, map, y, tolerance);
    for (const Walker& walker : walkers)
      if (walker.state != WalkState::goes_on) collect(walker);
    std::erase_if(walkers, [](const Walker& walker) { return walker.state != WalkState::goes_on; });
  }
  for (const Walker& walker : walkers) collect(walker);
  std::sort(result.stalled.begin(), result.stalled.end());
  return result;
}

}  // namespace bespoke
