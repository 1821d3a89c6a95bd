#include "bespoke/apply/unit_check.h"

#include <algorithm>
#include <array>

#include "bespoke/error.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/number_format.h"

namespace bespoke {
namespace {

// Between m, dm, cm and mm; inches, feet and these; feet and inches.
constexpr std::array unit_ratios{10.0, 100.0, 1000.0, 25.4, 2.54, 39.37, 304.8, 30.48, 3.2808, 12.0};

constexpr Eigen::Index max_points = 2000;  // tell as much as more
// Of the model's diagonal: what is made around it is neither a speck nor a landscape.
constexpr double min_size = 0.05, largest_size = 2;
constexpr double max_of_the_points = 0.9;
// Twenty factors are tried: so many points are hardly all near by chance.
constexpr Eigen::Index min_points = 8;

Points sample_of(const Points& points) {
  if (points.cols() <= max_points) return points;
  Points sample(3, max_points);
  for (Eigen::Index i = 0; i < max_points; ++i) sample.col(i) = points.col(i * points.cols() / max_points);
  return sample;
}

/// The share of points that u moves.
double share_in_band(const ElasticMap& elastic, const Points& points) {
  const Points u = elastic.displacement(points);
  return static_cast<double>((u.array() != 0).colwise().any().count()) / static_cast<double>(points.cols());
}

}  // namespace

std::string require_unit_of_map(const std::string& name, const Points& points, const ElasticMap& elastic,
                                const Box& model) {
  if (points.cols() == 0) return {};
  const Points sample = sample_of(points);
  const double size = diagonal(points), model_size = model.diagonal().norm();
  if (share_in_band(elastic, sample) > 0) return {};
  for (const double ratio : unit_ratios)
    for (const double factor : {ratio, 1 / ratio}) {
      const double scaled = factor * size;
      if (!(scaled > min_size * model_size && scaled < largest_size * model_size)) continue;
      if (share_in_band(elastic, factor * sample) < max_of_the_points) continue;
      const std::string found = "none of its points is near the model, but multiplied by " +
                                format_number(factor, 4) +
                                " they would be, as if it were in another unit than the map; name the unit "
                                "of its coordinates (--unit mm, for instance), or --unit map to carry it as "
                                "it is";
      if (points.cols() < min_points) return found;
      throw InvalidInput(name + ": " + found);
    }
  return {};
}

}  // namespace bespoke
