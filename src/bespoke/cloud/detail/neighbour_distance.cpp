#include "bespoke/cloud/detail/neighbour_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/median.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

constexpr std::size_t point_grain = 512;

/// The square root of the k-th of the squared distances, of which the point itself has one.
double root_of_kth(std::vector<double>& squared, std::size_t k) {
  const auto kth = squared.begin() + static_cast<std::ptrdiff_t>(k);
  std::nth_element(squared.begin(), kth, squared.end());
  return std::sqrt(*kth);
}

/// The median over some of the points, spread over all of them, each compared with all.
double usual_distance(const Points& points, std::size_t k) {
  constexpr std::size_t max_samples = 128;  // the median to a few percent: it only sizes a grid's cells
  const auto count = static_cast<std::size_t>(points.cols());
  const std::size_t samples = std::min(count, max_samples);
  std::vector<double> found(samples);
  parallel_for(samples, 1, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squared(count);
    for (std::size_t sample = begin; sample < end; ++sample) {
      const Vector3 x = points.col(static_cast<Eigen::Index>(sample * count / samples));
      for (std::size_t i = 0; i < count; ++i)
        squared[i] = (points.col(static_cast<Eigen::Index>(i)) - x).squaredNorm();
      found[sample] = root_of_kth(squared, k);
    }
  });
  return median(std::move(found));
}

}  // namespace

std::vector<double> neighbour_distances(const Points& points, std::size_t k) {
  const double usual = usual_distance(points, k);
  const PointGrid grid(points, usual);
  std::vector<double> result(static_cast<std::size_t>(points.cols()),
                             std::numeric_limits<double>::infinity());
  parallel_for(result.size(), point_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<double> squared;
    for (std::size_t i = begin; i < end; ++i)
      for (const double radius : {usual, 2 * usual, 4 * usual, 8 * usual}) {
        squared.clear();
        grid.for_each_within(points.col(static_cast<Eigen::Index>(i)), radius,
                             [&](int, double squared_distance) { squared.push_back(squared_distance); });
        if (squared.size() <= k) continue;
        result[i] = root_of_kth(squared, k);
        break;
      }
  });
  return result;
}

}  // namespace bespoke
