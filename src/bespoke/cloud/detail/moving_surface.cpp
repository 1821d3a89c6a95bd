#include "bespoke/cloud/detail/moving_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace bespoke {
namespace {

// A shorter mean normal lies in the middle between sheets that face away from each other; the nearer one then
// decides. Larger values let a single point with a wrong normal outvote its neighbours.
constexpr double min_agreement = 0.1;

/// Rational, so that the same cloud gives the same bytes wherever arithmetic is IEEE's; about a Gaussian of
/// standard deviation h/√8.
double weight(double squared_distance, double reach) {
  const double rest = 1 - squared_distance / (reach * reach);
  const double square = rest * rest;
  return rest > 0 ? square * square : 0;
}

double largest_reach_of(const std::vector<SurfaceElement>& elements) {
  double largest = 0;
  for (const SurfaceElement& element : elements) largest = std::max(largest, element.reach);
  return largest;
}

}  // namespace

MovingSurface::MovingSurface(const std::vector<SurfaceElement>& elements, const Points& points)
    : elements_(elements), largest_reach_(largest_reach_of(elements)), grid_(points, largest_reach_) {}

void MovingSurface::gather(const Vector3& center, double radius, std::vector<int>& near) const {
  near.clear();
  grid_.for_each_within(center, radius + largest_reach_, [&](int index, double squared_distance) {
    const double reach = radius + elements_[static_cast<std::size_t>(index)].reach;
    if (squared_distance < reach * reach) near.push_back(index);
  });
}

/// Direction of the weighted mean of the normals, or of the nearest where these cancel; zero without any.
Vector3 MovingSurface::facing(const Vector3& x, const std::vector<int>& near) const {
  Vector3 sum = Vector3::Zero();
  double weights = 0, least = std::numeric_limits<double>::infinity();
  Vector3 nearest = Vector3::Zero();
  for (const int index : near) {
    const SurfaceElement& element = elements_[static_cast<std::size_t>(index)];
    const double squared_distance = (x - element.point).squaredNorm();
    const double w = weight(squared_distance, element.reach);
    if (w == 0) continue;
    sum += w * element.normal;
    weights += w;
    if (squared_distance < least) {
      least = squared_distance;
      nearest = element.normal;
    }
  }
  const double length = sum.norm();
  return length > min_agreement * weights ? Vector3(sum / length) : nearest;
}

std::optional<SurfaceEstimate> MovingSurface::estimate(const Vector3& x, const std::vector<int>& near) const {
  const Vector3 direction = facing(x, near);
  Vector3 normals = Vector3::Zero(), offsets = Vector3::Zero();
  double weights = 0, heights = 0, reaches = 0, nearest = 1;
  for (const int index : near) {
    const SurfaceElement& element = elements_[static_cast<std::size_t>(index)];
    const Vector3 offset = x - element.point;
    const double squared = offset.squaredNorm();
    const double w = weight(squared, element.reach) * std::max(0., element.normal.dot(direction));
    if (w == 0) continue;
    nearest = std::min(nearest, squared / (element.reach * element.reach));
    weights += w;
    normals += w * element.normal;
    offsets += w * offset;
    heights += w * element.normal.dot(offset);
    reaches += w * element.reach;
  }
  if (!(weights > 0)) return std::nullopt;
  const Vector3 normal = normals.normalized();
  return SurfaceEstimate{(heights + normal.dot(offsets)) / (2 * weights), normal, offsets.norm() / reaches,
                         std::sqrt(nearest)};
}

}  // namespace bespoke
