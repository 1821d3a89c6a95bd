#include "bespoke/bake/detail/leaf_forecast.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "bespoke/bake/detail/octant_test.h"

namespace bespoke {
namespace {

constexpr std::size_t samples_per_level = 1024;
constexpr std::uint64_t seed = 11;
// Leaves that rims add to those that errors ask for (measured: 1.2 to 1.6 on the shared cases).
constexpr double share_of_rims = 1.6;

constexpr int coarse_edge = leaf_edge / 2 + 1;  // of an octant's nodes
constexpr int coarse_nodes = coarse_edge * coarse_edge * coarse_edge;
constexpr int points_per_octant = coarse_nodes + tested_nodes;

// Mean of the coarse nodes around a node of the octant.
Vector3 interpolated(const Eigen::Ref<const Points>& coarse, const std::array<int, 3>& node) {
  Vector3 sum = Vector3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    int place = 0;
    for (int axis = 0; axis < 3; ++axis)
      place = place * coarse_edge + (node[axis] + (corner >> (2 - axis) & node[axis] & 1)) / 2;
    sum += coarse.col(place);
  }
  return sum / 8;
}

}  // namespace

std::vector<double> LeafForecast::errors_of(const ElasticMap& map, const Lattice& coarse,
                                            const std::vector<Sample>& octants) {
  const double voxel_size = coarse.voxel_size / 2;
  Points x(3, static_cast<Eigen::Index>(points_per_octant * octants.size()));
  Eigen::Index column = 0;
  for (const Sample& octant : octants) {
    const Vector3 corner(octant.leaf[0], octant.leaf[1], octant.leaf[2]);
    const auto add = [&](const std::array<int, 3>& node) {
      x.col(column++) =
          coarse.origin + voxel_size * (leaf_edge * corner + Vector3(node[0], node[1], node[2]));
    };
    for (int n = 0; n < coarse_nodes; ++n)
      add({n / (coarse_edge * coarse_edge) * 2, n / coarse_edge % coarse_edge * 2, n % coarse_edge * 2});
    for (int number = 0; number < tested_nodes; ++number) add(tested_node(number));
  }
  const Points u = map.displacement(x);
  evaluated_points_ += static_cast<std::size_t>(x.cols());
  std::vector<double> errors(octants.size());
  for (std::size_t n = 0; n < octants.size(); ++n) {
    const auto first = static_cast<Eigen::Index>(points_per_octant * n);
    for (int number = 0; number < tested_nodes; ++number)
      errors[n] = std::max(errors[n], (interpolated(u.middleCols<coarse_nodes>(first), tested_node(number)) -
                                       u.col(first + coarse_nodes + number))
                                          .norm());
  }
  return errors;
}

LeafForecast::LeafForecast(const ElasticMap& map, const Lattice& coarsest,
                           const std::vector<LeafCoordinates>& band, double tolerance,
                           const Progress& progress) {
  std::mt19937_64 engine(seed);
  std::vector<Sample> refined;
  for (const LeafCoordinates& leaf : band)
    refined.push_back({leaf, 1, std::numeric_limits<double>::infinity(), coarsest.voxel_size});
  samples_ = refined;
  Lattice lattice = coarsest;
  while (!refined.empty() && lattice.voxel_size / 2 >= least_voxel_of_tolerance * tolerance) {
    progress.check();
    double total = 0;
    for (const Sample& leaf : refined) total += 8 * leaf.weight;
    // Every octant stands for the same number, so draw them at even distances along the sum of their weights.
    const bool all = 8 * refined.size() <= samples_per_level;
    const double distance = total / samples_per_level;
    double next = distance * (static_cast<double>(engine() >> 11) * 0x1p-53), passed = 0;
    std::vector<Sample> octants;
    for (const Sample& leaf : refined)
      for (int octant = 0; octant < 8; ++octant) {
        Sample sample = leaf;
        sample.leaf = {2 * leaf.leaf[0] + (octant >> 2 & 1), 2 * leaf.leaf[1] + (octant >> 1 & 1),
                       2 * leaf.leaf[2] + (octant & 1)};
        sample.voxel_size = lattice.voxel_size / 2;
        if (all) {
          octants.push_back(sample);
          continue;
        }
        sample.weight = distance;
        // A leaf that stands for many may be drawn more than once.
        for (passed += leaf.weight; next < passed; next += distance) octants.push_back(sample);
      }
    const std::vector<double> errors = errors_of(map, lattice, octants);
    refined.clear();
    for (std::size_t n = 0; n < octants.size(); ++n) {
      octants[n].tolerance = std::min(octants[n].tolerance, errors[n] / test_margin);
      if (octants[n].tolerance > tolerance) refined.push_back(octants[n]);
    }
    samples_.insert(samples_.end(), refined.begin(), refined.end());
    lattice.voxel_size /= 2;
  }
}

double LeafForecast::leaves(double tolerance) const {
  double band = 0, deeper = 0;
  for (const Sample& sample : samples_) {
    if (std::isinf(sample.tolerance))
      band += sample.weight;
    else if (sample.tolerance > tolerance && sample.voxel_size >= least_voxel_of_tolerance * tolerance)
      deeper += sample.weight;
  }
  return band + share_of_rims * deeper;
}

std::optional<double> LeafForecast::tolerance_for(double leaf_count) const {
  std::vector<double> tolerances;
  for (const Sample& sample : samples_)
    if (!std::isinf(sample.tolerance)) tolerances.push_back(sample.tolerance);
  std::sort(tolerances.begin(), tolerances.end());
  const auto found = std::partition_point(tolerances.begin(), tolerances.end(),
                                          [&](double tolerance) { return leaves(tolerance) > leaf_count; });
  if (found == tolerances.end()) return std::nullopt;
  return *found;
}

}  // namespace bespoke
