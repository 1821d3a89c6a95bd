#include "bespoke/pattern/flattening/nearest_stretch.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bespoke {
namespace {

/// The stretch p nearest to (s, t) with p q = 1, by Newton's method for (p − s)² + (1/p − t)².
double area_keeping_stretch(double s, double t) {
  constexpr int steps = 20;  // it is squared convergence from the geometric mean
  double p = std::sqrt(s / t);
  for (int k = 0; k < steps; ++k) {
    const double slope = (p - s) - (1 / p - t) / (p * p);
    const double bend = 1 + 3 / (p * p * p * p) - 2 * t / (p * p * p);
    const double next = bend > 0 ? p - slope / bend : p;
    p = std::clamp(next, p / 2, 2 * p);
  }
  return p;
}

}  // namespace

Eigen::Matrix2d nearest_stretch(FlatteningMethod method, const Eigen::Matrix2d& jacobian) {
  // A matrix is the sum of a similarity and a mirrored one, of scales (s + t) / 2 and (s − t) / 2.
  const double e = (jacobian(0, 0) + jacobian(1, 1)) / 2, f = (jacobian(1, 0) - jacobian(0, 1)) / 2;
  Eigen::Matrix2d similar;
  similar << e, -f, f, e;
  const double mean = std::hypot(e, f);
  if (!(mean > 0)) return Eigen::Matrix2d::Identity();
  if (method == FlatteningMethod::conformal) return similar;
  if (method == FlatteningMethod::rigid) return similar / mean;
  const Eigen::Matrix2d mirrored = jacobian - similar;
  const double half = std::hypot(mirrored(0, 0), mirrored(1, 0));
  if (!(mean > half)) return similar / mean;
  const double p = area_keeping_stretch(mean + half, mean - half);
  const double difference = (p - 1 / p) / 2;
  return similar * ((p + 1 / p) / 2 / mean) +
         (half > 0 ? Eigen::Matrix2d(mirrored * (difference / half)) : Eigen::Matrix2d::Zero().eval());
}

double unflipped_step(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {
  const double square = b.determinant(), constant = a.determinant();
  const double linear = (a + b).determinant() - square - constant;
  const double root = linear * linear - 4 * square * constant;
  if (!(root >= 0)) return std::numeric_limits<double>::infinity();
  // The stable form of the quadratic formula; 2 c / (−b ± …) is finite where `square` vanishes.
  const double sum = -(linear + (linear < 0 ? -1 : 1) * std::sqrt(root)) / 2;
  double smallest = std::numeric_limits<double>::infinity();
  for (const double s : {square == 0 ? smallest : sum / square, sum == 0 ? smallest : constant / sum})
    if (s > 0) smallest = std::min(smallest, s);
  return smallest;
}

}  // namespace bespoke
