#pragma once

#include <cstdint>
#include <vector>

#include "bespoke/bake/bake.h"
#include "bespoke/bake/error_points.h"
#include "bespoke/mapping/elastic_map.h"
#include "bespoke/progress.h"

namespace bespoke {

/// Compares pyramids with the map at points that no decision used before. Each comparison moves the pyramid
/// in and out, and leaves in worst() the points that miss the tolerance, or nearly do.
class Measurement {
 public:
  /// `band`: the leaves of a lattice that hold the support. Map, options and progress must outlive it.
  Measurement(const ElasticMap& map, const Lattice& band_lattice, std::vector<LeafCoordinates> band,
              const BakeOptions& options, const Progress& progress);

  /// Largest error (mesh units) at so many points in each of the surface's cells, as far as the limits allow.
  double quickly(Pyramid& pyramid, std::size_t points_per_cell);

  /// The same in the cells of worst() and those around them.
  double near_worst(Pyramid& pyramid);

  /// Everywhere: fills the error of BakeSummary and its figures about the sample.
  double fully(Pyramid& pyramid, BakeSummary& summary);

  const Points& worst() const { return worst_; }

  /// From now on worst() has points of a smaller error too.
  void widen_worst();

 private:
  /// Sought anew where the pyramid has other leaves than the last.
  const std::vector<FinestCell>& surface_cells(const Pyramid& pyramid);
  double search(Pyramid& pyramid, const std::vector<FinestCell>& cells, std::size_t points_per_cell);
  double measure(Pyramid& pyramid, const Points& x);

  const ElasticMap& map_;
  Lattice band_lattice_;
  std::vector<LeafCoordinates> band_;
  const BakeOptions& options_;
  const Progress& progress_;
  std::uint64_t seed_;
  std::vector<FinestCell> surface_cells_;
  std::vector<std::vector<LeafCoordinates>> leaves_of_cells_;
  double worst_share_;  // of the tolerance, above which points are among the worst
  std::vector<double> errors_;
  Points worst_;
};

}  // namespace bespoke
