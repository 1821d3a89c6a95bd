#include "bespoke/apply/unit_check.h"

#include <array>
#include <cmath>
#include <optional>

#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

// Between m, dm, cm and mm; inches, feet and these; feet and inches.
constexpr std::array unit_ratios{10.0, 100.0, 1000.0, 25.4, 2.54, 39.37, 304.8, 30.48, 3.2808, 12.0};

constexpr Eigen::Index max_points = 2000;  // tell as much as more
constexpr Eigen::Index few_points = 200;   // of a factor that is tried
// Of the model's diagonal: what is made around it is neither a speck nor a landscape.
constexpr double min_size = 0.05, largest_size = 2;
constexpr double nearly_all = 0.9, hardly_any = 0.1;
// Twenty factors are tried: so many points are hardly all near by chance.
constexpr Eigen::Index min_points = 8;

Points sample_of(const Points& points, Eigen::Index count) {
  if (points.cols() <= count) return points;
  Points sample(3, count);
  for (Eigen::Index i = 0; i < count; ++i) sample.col(i) = points.col(i * points.cols() / count);
  return sample;
}

/// The share of points that u moves.
double share_in_band(const ElasticMap& elastic, const Points& points) {
  const Points u = elastic.displacement(points);
  return static_cast<double>((u.array() != 0).colwise().any().count()) / static_cast<double>(points.cols());
}

bool is_usual(double size) { return size > min_size && size < largest_size; }

/// Of the factors that are accepted the one that brings the product's size, of the model's, nearest to it.
template <class Accepted>
std::optional<double> best_factor(double size, const Accepted& is_accepted) {
  std::optional<double> best;
  for (const double ratio : unit_ratios)
    for (const double factor : {ratio, 1 / ratio}) {
      const bool is_better = !best || std::abs(std::log(factor * size)) < std::abs(std::log(*best * size));
      if (is_usual(factor * size) && is_better && is_accepted(factor)) best = factor;
    }
  return best;
}

}  // namespace

std::string require_unit_of_map(const std::string& name, const Points& points, const ElasticMap& elastic,
                                const Box& model) {
  if (points.cols() == 0) return {};
  const Points few = sample_of(points, few_points);
  const double size = diagonal(points), model_size = model.diagonal().norm();
  const double share = share_in_band(elastic, sample_of(points, max_points));
  if (share > 0 && (size == 0 || is_usual(size / model_size))) return {};
  const std::optional<double> factor = best_factor(
      size / model_size, [&](double tried) { return share_in_band(elastic, tried * few) >= nearly_all; });
  if (!factor) return {};
  const std::string found =
      (share == 0
           ? "none of its points is near the model, but multiplied by "
           : "its size is " + format_number(size / model_size, 2) + " of the model's, but multiplied by ") +
      format_number(*factor, 4) + (share == 0 ? " they would be" : " it would lie around it") +
      ", as if it were in another unit than the map; name the unit of its coordinates (--unit mm, for "
      "instance), or --unit map to carry it as it is";
  // A button is as small as a dress in metres; a landscape is not carried by mistake.
  const bool is_refused = share == 0 || (size > model_size && share < hardly_any);
  if (points.cols() < min_points || !is_refused) return found;
  throw InvalidInput(name + ": " + found);
}

}  // namespace bespoke
