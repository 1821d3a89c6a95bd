#pragma once

#include <cstddef>
#include <optional>
#include <random>
#include <vector>

#include "bespoke/bake/band.h"
#include "bespoke/bake/node_values.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Half the tolerance: below it voxels only chase jumps (PyramidBuilder).
inline constexpr double min_voxel_of_tolerance = 0.5;

/// How many leaves a nested pyramid will take, before they are: a random sample of octants is refined all the
/// way, a thousand a level, each standing for as many others as were not drawn. What one sample says about
/// a tolerance it says about all larger ones as well, because an octant's error is known, not only whether it
/// passes.
class LeafForecast {
 public:
  /// `band`: the leaves of the lattice `coarsest`. Evaluates the map at up to four million points.
  LeafForecast(const ElasticMap& map, const Lattice& coarsest, const std::vector<LeafCoordinates>& band,
               double tolerance, NodeValues nodes, const Progress& progress);

  /// Expected leaves at a tolerance (mesh units) not below the constructor's.
  double leaves(double tolerance) const;

  /// The least tolerance (mesh units) at which no more than so many leaves are expected; nothing when the
  /// band alone takes more.
  std::optional<double> tolerance_for(double leaf_count) const;

  std::size_t evaluated_points() const { return evaluated_points_; }

 private:
  struct Sample {
    LeafCoordinates leaf;
    double weight;      // leaves that it stands for
    double tolerance;   // below which it is needed: least error of the octants above it, mesh units
    double voxel_size;  // mesh units
  };
  static std::vector<Sample> draw_octants(const std::vector<Sample>& leaves, std::mt19937_64& engine);
  std::vector<double> errors_of(const ElasticMap& map, const Lattice& fine,
                                const std::vector<Sample>& octants, NodeValues nodes);

  double min_voxel(double tolerance) const { return min_voxel_of_tolerance * tolerance / growth_; }

  double growth_;  // of the map: tolerances are of its values, voxels of its places
  std::vector<Sample> samples_;
  std::size_t evaluated_points_ = 0;
};

}  // namespace bespoke
