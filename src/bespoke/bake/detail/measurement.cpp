#include "bespoke/bake/detail/measurement.h"

#include <algorithm>
#include <utility>

#include "bespoke/lattice/baked_map.h"

namespace bespoke {
namespace {

constexpr std::uint64_t error_seed = 3;
// Points of an error above this share of the tolerance are refined when a round does not meet it: what one
// sample finds just below, the next will find just above. Widened, its square, its cube, and so on.
constexpr double worst_share = 0.75;
// Of BakeOptions::error_points: points on the surface that the record counts, or that a search takes with
// several in a cell, and points of a search at most.
constexpr std::size_t recorded_surface_points = 2;
constexpr std::size_t max_searched_points = 5;

// Where detail is: as many in a small leaf as in a large one.
std::vector<FinestCell> cells_in_all_leaves(const Pyramid& pyramid, std::uint64_t seed) {
  constexpr std::size_t cells_per_leaf = 16;
  Points x(3, static_cast<Eigen::Index>(cells_per_leaf * pyramid.leaf_count()));
  Eigen::Index column = 0;
  for (const PyramidLevel& level : pyramid.levels) {
    const std::size_t count = cells_per_leaf * level.leaves.size();
    x.middleCols(column, static_cast<Eigen::Index>(count)) =
        random_points({pyramid.origin, level.voxel_size}, level.leaves, count, seed);
    column += static_cast<Eigen::Index>(count);
  }
  return finest_cells_at(pyramid, x);
}

// Level by level.
std::vector<std::vector<LeafCoordinates>> leaves_of(const Pyramid& pyramid) {
  std::vector<std::vector<LeafCoordinates>> all;
  for (const PyramidLevel& level : pyramid.levels) all.push_back(level.leaves);
  return all;
}

// Each cell with the 26 around it.
std::vector<FinestCell> with_neighbours(const Pyramid& pyramid, const std::vector<FinestCell>& cells) {
  Points centers(3, static_cast<Eigen::Index>(neighbour_steps * cells.size()));
  Eigen::Index column = 0;
  for (const FinestCell& cell : cells)
    for (int side = 0; side < neighbour_steps; ++side)
      centers.col(column++) =
          pyramid.lattice(cell.level)
              .at(as_vector(moved(cell.node, neighbour_step(side))) + Vector3::Constant(0.5));
  return finest_cells_at(pyramid, centers);
}

}  // namespace

Measurement::Measurement(const ElasticMap& map, const Lattice& band_lattice,
                         std::vector<LeafCoordinates> band, const BakeOptions& options,
                         const Progress& progress)
    : map_(map),
      band_lattice_(band_lattice),
      band_(std::move(band)),
      options_(options),
      progress_(progress),
      seed_(error_seed),
      worst_share_(worst_share) {}

double Measurement::quickly(Pyramid& pyramid, std::size_t points_per_cell) {
  return search(pyramid, surface_cells(pyramid), points_per_cell);
}

double Measurement::near_worst(Pyramid& pyramid) {
  return search(pyramid, with_neighbours(pyramid, finest_cells_at(pyramid, worst_)), 1);
}

double Measurement::fully(Pyramid& pyramid, BakeSummary& summary) {
  const std::vector<FinestCell>& cells = surface_cells(pyramid);
  Points x = points_in_cells(pyramid, cells, recorded_surface_points * options_.error_points, ++seed_);
  const Points random = random_points(band_lattice_, band_, options_.error_points, ++seed_);
  summary.surface_cells = cells.size();
  summary.error_surface_points = static_cast<std::size_t>(x.cols());
  summary.error_random_points = static_cast<std::size_t>(random.cols());
  x.conservativeResize(3, x.cols() + random.cols());
  x.rightCols(random.cols()) = random;
  measure(pyramid, x);
  summary.error = summarize(std::move(errors_));
  return summary.error.max;
}

void Measurement::widen_worst() { worst_share_ *= worst_share; }

const std::vector<FinestCell>& Measurement::surface_cells(const Pyramid& pyramid) {
  if (!options_.surface) {
    surface_cells_ = cells_in_all_leaves(pyramid, seed_);
  } else if (std::vector<std::vector<LeafCoordinates>> leaves = leaves_of(pyramid);
             leaves != leaves_of_cells_) {
    surface_cells_ = finest_cells_on(pyramid, *options_.surface);
    leaves_of_cells_ = std::move(leaves);
  }
  return surface_cells_;
}

double Measurement::search(Pyramid& pyramid, const std::vector<FinestCell>& cells,
                           std::size_t points_per_cell) {
  const std::size_t one_each = std::min(cells.size(), max_searched_points * options_.error_points);
  const std::size_t several =
      std::min(points_per_cell * cells.size(), recorded_surface_points * options_.error_points);
  const std::size_t count = std::max(one_each, several);
  return measure(pyramid, points_in_cells(pyramid, cells, count, ++seed_));
}

double Measurement::measure(Pyramid& pyramid, const Points& x) {
  BakedMap baked(map_.affine(), std::move(pyramid));
  errors_ = displacement_errors(baked, map_, x, progress_, options_.downstream_map);
  pyramid = std::move(baked).release();
  std::vector<Eigen::Index> worst;
  for (std::size_t i = 0; i < errors_.size(); ++i)
    if (!(errors_[i] <= worst_share_ * options_.tolerance)) worst.push_back(static_cast<Eigen::Index>(i));
  // The largest first, should there not be leaves for all.
  std::stable_sort(worst.begin(), worst.end(), [&](Eigen::Index a, Eigen::Index b) {
    return errors_[static_cast<std::size_t>(a)] > errors_[static_cast<std::size_t>(b)];
  });
  worst_ = x(Eigen::all, worst);
  return errors_.empty() ? 0 : *std::max_element(errors_.begin(), errors_.end());
}

}  // namespace bespoke
