#include "bespoke/bake/pyramid/leaf_forecast.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bespoke/bake/pyramid/balanced_values.h"
#include "bespoke/bake/pyramid/octant_test.h"
#include "bespoke/mapping/affine_map.h"

namespace bespoke {
namespace {

constexpr std::size_t samples_per_level = 1024;
constexpr std::uint64_t forecast_seed = 11;
// Leaves that level boundaries add to those that errors require (measured: 1.2 to 1.6 on the shared cases).
constexpr double share_of_rims = 1.6;

// Of an octant's coarse nodes and of those around them, by which they are balanced.
constexpr int inner_edge = leaf_edge / 2 + 1;
constexpr int coarse_edge = inner_edge + 2;
constexpr int coarse_nodes = coarse_edge * coarse_edge * coarse_edge;
constexpr int points_per_octant = coarse_nodes + tested_nodes;

constexpr int coarse_number(const LatticeCoordinates& place) {
  return (place[0] * coarse_edge + place[1]) * coarse_edge + place[2];
}

constexpr LatticeCoordinates coarse_place(int number) {
  return {number / (coarse_edge * coarse_edge), number / coarse_edge % coarse_edge, number % coarse_edge};
}

constexpr bool is_inner(const LatticeCoordinates& place) {
  return std::all_of(place.begin(), place.end(), [](int at) { return at > 0 && at <= inner_edge; });
}

// In the nodes of the octant's leaf.
LatticeCoordinates coarse_node(int number) {
  const LatticeCoordinates place = coarse_place(number);
  return {2 * place[0] - 2, 2 * place[1] - 2, 2 * place[2] - 2};
}

// What balanced_values makes of the inner ones.
Points balanced(const Eigen::Ref<const Points>& coarse) {
  Points values = coarse;
  for (int number = 0; number < coarse_nodes; ++number) {
    const LatticeCoordinates place = coarse_place(number);
    if (!is_inner(place) || coarse.col(number).isZero(0)) continue;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      LatticeCoordinates step{};
      step[axis] = 1;
      const int to_next = coarse_number(step);
      values.col(number) -= share_of_difference * (coarse.col(number - to_next) - 2 * coarse.col(number) +
                                                   coarse.col(number + to_next));
    }
  }
  return values;
}

// Mean of the coarse nodes around a node of the octant.
Vector3 interpolated(const Eigen::Ref<const Points>& coarse, const LatticeCoordinates& node) {
  Vector3 sum = Vector3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const LatticeCoordinates step = corner_step(corner);
    LatticeCoordinates place;
    for (std::size_t axis = 0; axis < 3; ++axis)
      place[axis] = 1 + (node[axis] + (step[axis] & node[axis])) / 2;
    sum += coarse.col(coarse_number(place));
  }
  return sum / 8;
}

}  // namespace

// `fine`: the lattice of the leaves that cover the octants.
std::vector<double> LeafForecast::errors_of(const ElasticMap& map, const Lattice& fine,
                                            const std::vector<Sample>& octants, NodeValues nodes) {
  Points x(3, static_cast<Eigen::Index>(points_per_octant * octants.size()));
  Eigen::Index column = 0;
  for (const Sample& octant : octants) {
    const LatticeCoordinates first = first_node(octant.leaf);
    for (int n = 0; n < coarse_nodes; ++n) x.col(column++) = fine(moved(first, coarse_node(n)));
    for (int n = 0; n < tested_nodes; ++n) x.col(column++) = fine(moved(first, tested_node(n)));
  }
  const Points u = map.displacement(x);
  evaluated_points_ += static_cast<std::size_t>(x.cols());
  std::vector<double> errors(octants.size());
  for (std::size_t n = 0; n < octants.size(); ++n) {
    const auto of_octant = u.middleCols<points_per_octant>(static_cast<Eigen::Index>(points_per_octant * n));
    const Points sampled = of_octant.leftCols<coarse_nodes>();
    const Points coarse = nodes == NodeValues::balanced ? balanced(sampled) : sampled;
    for (int test = 0; test < tested_nodes; ++test) {
      const Vector3 expected = interpolated(coarse, tested_node(test));
      errors[n] = std::max(errors[n], (expected - of_octant.col(coarse_nodes + test)).norm());
    }
  }
  return errors;
}

// All octants of the leaves where they are few. Else every octant stands for the same number, so they are
// drawn at even distances along the sum of their weights; a leaf that stands for many may be drawn more than
// once.
std::vector<LeafForecast::Sample> LeafForecast::draw_octants(const std::vector<Sample>& leaves,
                                                             std::mt19937_64& engine) {
  double total = 0;
  for (const Sample& leaf : leaves) total += 8 * leaf.weight;
  const bool all = 8 * leaves.size() <= samples_per_level;
  const double distance = total / samples_per_level;
  double next = distance * (static_cast<double>(engine() >> 11) * 0x1p-53), passed = 0;
  std::vector<Sample> octants;
  for (const Sample& leaf : leaves)
    for (int octant = 0; octant < 8; ++octant) {
      Sample sample = leaf;
      sample.leaf = child_of(leaf.leaf, octant);
      sample.voxel_size = leaf.voxel_size / 2;
      if (all) {
        octants.push_back(sample);
        continue;
      }
      sample.weight = distance;
      for (passed += leaf.weight; next < passed; next += distance) octants.push_back(sample);
    }
  return octants;
}

LeafForecast::LeafForecast(const ElasticMap& map, const Lattice& coarsest,
                           const std::vector<LeafCoordinates>& band, double tolerance, NodeValues nodes,
                           const Progress& progress)
    : growth_(power_of_two_scale(map.affine())) {
  std::mt19937_64 engine(forecast_seed);
  std::vector<Sample> refined;
  for (const LeafCoordinates& leaf : band)
    refined.push_back({leaf, 1, std::numeric_limits<double>::infinity(), coarsest.voxel_size});
  samples_ = refined;
  Lattice fine{coarsest.origin, coarsest.voxel_size / 2};
  for (; !refined.empty() && fine.voxel_size >= min_voxel(tolerance); fine.voxel_size /= 2) {
    progress.check();
    std::vector<Sample> octants = draw_octants(refined, engine);
    const std::vector<double> errors = errors_of(map, fine, octants, nodes);
    refined.clear();
    for (std::size_t n = 0; n < octants.size(); ++n) {
      octants[n].tolerance = std::min(octants[n].tolerance, errors[n] / test_margin);
      if (octants[n].tolerance > tolerance) refined.push_back(octants[n]);
    }
    samples_.insert(samples_.end(), refined.begin(), refined.end());
  }
}

double LeafForecast::leaves(double tolerance) const {
  double band = 0, deeper = 0;
  for (const Sample& sample : samples_) {
    if (std::isinf(sample.tolerance))
      band += sample.weight;
    else if (sample.tolerance > tolerance && sample.voxel_size >= min_voxel(tolerance))
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
