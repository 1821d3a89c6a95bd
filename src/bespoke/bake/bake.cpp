#include "bespoke/bake/bake.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "bespoke/bake/detail/pyramid_builder.h"
#include "bespoke/bake/detail/repair.h"
#include "bespoke/bake/detail/uniform_bake.h"
#include "bespoke/bake/sampling.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

constexpr std::uint64_t error_seed = 3;
// Places where a finished pyramid misses the tolerance are refined and it is measured anew: at a few points,
// around those that missed it, then everywhere.
constexpr int quick_rounds = 2;
constexpr int local_rounds = 6;
constexpr int full_rounds = 3;
constexpr double most_left_by_a_round = 0.7;
constexpr int rounds_against_folds = 3;
// More are no isolated places: the map itself is too steep for its voxels there, and no local change mends
// it.
constexpr std::size_t most_mendable_folds = 20'000;
// Points of an error above this share of the tolerance are refined when a round does not meet it: what one
// sample finds just below, the next will find just above.
constexpr double refined_share = 0.85;
// Of the points on the surface, in error_points.
constexpr std::size_t most_surface_points = 8;

bool is_empty(const Support& support) {
  for (const BallCloud& cloud : support.clouds)
    if (cloud.centers.cols() > 0) return false;
  return true;
}

// Where detail is: as many in a small leaf as in a large one.
std::vector<FinestCell> cells_in_all_leaves(const Pyramid& pyramid, std::uint64_t seed) {
  constexpr std::size_t cells_per_leaf = 16;
  std::size_t leaves = 0;
  for (const PyramidLevel& level : pyramid.levels) leaves += level.leaves.size();
  Points x(3, static_cast<Eigen::Index>(cells_per_leaf * leaves));
  Eigen::Index column = 0;
  for (const PyramidLevel& level : pyramid.levels) {
    const auto count = static_cast<Eigen::Index>(cells_per_leaf * level.leaves.size());
    x.middleCols(column, count) = random_points({pyramid.origin, level.voxel_size}, level.leaves,
                                                cells_per_leaf * level.leaves.size(), seed);
    column += count;
  }
  return finest_cells_at(pyramid, x);
}

// Compares pyramids with the map at points that no decision used before.
class Measurement {
 public:
  Measurement(const ElasticMap& map, const Lattice& band_lattice, const std::vector<LeafCoordinates>& band,
              const BakeOptions& options, const Progress& progress)
      : map_(map), band_lattice_(band_lattice), band_(band), options_(options), progress_(progress) {}

  // All leave in worst() the points that miss the tolerance, or nearly do. The pyramid is moved in and out.
  double quickly(Pyramid& pyramid) {
    const std::vector<FinestCell> cells = surface_cells(pyramid);
    return measure(pyramid, points_in_cells(pyramid, cells, options_.error_points / 4, ++seed_),
                   Points(3, 0));
  }
  // In the cells of worst() and those around them.
  double near_worst(Pyramid& pyramid) {
    const std::vector<FinestCell> hit = finest_cells_at(pyramid, worst_);
    Points around(3, static_cast<Eigen::Index>(27 * hit.size()));
    Eigen::Index column = 0;
    for (const FinestCell& cell : hit)
      for (int side = 0; side < 27; ++side)
        around.col(column++) =
            pyramid.origin +
            pyramid.levels[static_cast<std::size_t>(cell.level)].voxel_size *
                (Vector3(cell.node[0] + side / 9, cell.node[1] + side / 3 % 3, cell.node[2] + side % 3) -
                 Vector3::Constant(0.5));
    const std::vector<FinestCell> cells = finest_cells_at(pyramid, around);
    return measure(pyramid, points_in_cells(pyramid, cells, options_.error_points / 4, ++seed_),
                   Points(3, 0));
  }
  double fully(Pyramid& pyramid, BakeSummary& summary) {
    const std::vector<FinestCell> cells = surface_cells(pyramid);
    Points surface = points_in_cells(pyramid, cells, most_surface_points * options_.error_points, ++seed_);
    Points random = random_points(band_lattice_, band_, options_.error_points, ++seed_);
    summary.surface_cells = cells.size();
    summary.error_surface_points = static_cast<std::size_t>(surface.cols());
    summary.error_random_points = static_cast<std::size_t>(random.cols());
    measure(pyramid, std::move(surface), std::move(random));
    summary.error = summarize(std::move(errors_));
    return summary.error.max;
  }

  const Points& worst() const { return worst_; }

 private:
  std::vector<FinestCell> surface_cells(const Pyramid& pyramid) const {
    return options_.surface ? finest_cells_on(pyramid, *options_.surface)
                            : cells_in_all_leaves(pyramid, seed_);
  }

  double measure(Pyramid& pyramid, Points first, Points second) {
    BakedMap baked(map_.affine(), std::move(pyramid));
    errors_.clear();
    std::vector<Vector3> worst;
    double largest = 0;
    for (const Points* x : {&first, &second}) {
      const std::vector<double> errors = displacement_errors(baked, map_, *x, progress_);
      for (std::size_t i = 0; i < errors.size(); ++i) {
        if (!(errors[i] <= refined_share * options_.tolerance))
          worst.push_back(x->col(static_cast<Eigen::Index>(i)));
        largest = std::max(largest, errors[i]);
      }
      errors_.insert(errors_.end(), errors.begin(), errors.end());
    }
    worst_.resize(3, static_cast<Eigen::Index>(worst.size()));
    for (std::size_t i = 0; i < worst.size(); ++i) worst_.col(static_cast<Eigen::Index>(i)) = worst[i];
    pyramid = std::move(baked).release();
    return largest;
  }

  const ElasticMap& map_;
  Lattice band_lattice_;
  std::vector<LeafCoordinates> band_;
  const BakeOptions& options_;
  const Progress& progress_;
  std::uint64_t seed_ = error_seed;
  std::vector<double> errors_;
  Points worst_;
};

Bake bake_uniform(const ElasticMap& map, double voxel_size, const BakeOptions& options,
                  const Progress& progress) {
  const Support support = map.support();
  const Lattice lattice{bounding_box(support).min(), voxel_size};
  const UniformEstimate estimate = estimate_uniform(map, lattice);
  require_memory(map, estimate, options.max_memory);

  Bake result;
  Stopwatch watch;
  result.summary.peak_bytes = static_cast<std::size_t>(estimate.bytes);
  const std::vector<LeafCoordinates> leaves = band_leaves(support, lattice);
  PyramidLevel level = sample_level(map, lattice, leaves, progress);
  round_values(level.values, options.tolerance, options.precision);
  keep_leaves(level, [](const LeafCoordinates&, bool zero) { return !zero; });
  result.summary.evaluated_points = leaves.size() * leaf_nodes;
  result.pyramid.origin = lattice.origin;
  result.pyramid.precision = options.precision;
  if (!level.leaves.empty()) result.pyramid.levels.push_back(std::move(level));
  result.summary.refine_seconds = watch.lap();
  Measurement(map, lattice, leaves, options, progress).fully(result.pyramid, result.summary);
  result.summary.measure_seconds = watch.lap();
  return result;
}

// Cells that fold although the map itself keeps its orientation in and around them: finer leaves will mend
// them.
Points needless_folds(const ElasticMap& map, const Pyramid& pyramid, const Certificate& certificate) {
  constexpr Eigen::Index probes = 9;
  Points x(3, probes * static_cast<Eigen::Index>(certificate.places.size()));
  for (std::size_t i = 0; i < certificate.places.size(); ++i) {
    const FoldedCell& cell = certificate.places[i];
    const double reach = 2 * pyramid.levels[static_cast<std::size_t>(cell.level)].voxel_size;
    const auto first = probes * static_cast<Eigen::Index>(i);
    x.col(first) = cell.center;
    for (int corner = 0; corner < 8; ++corner)
      x.col(first + 1 + corner) =
          cell.center + reach * Vector3(corner & 4 ? 1 : -1, corner & 2 ? 1 : -1, corner & 1 ? 1 : -1);
  }
  const Points gradient = map.displacement_gradient(x);
  Points needless(3, static_cast<Eigen::Index>(certificate.places.size()));
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < needless.cols(); ++i) {
    bool upright = true;
    for (Eigen::Index probe = probes * i; probe < probes * (i + 1); ++probe)
      upright = upright && (map.affine().linear + gradient.middleCols<3>(3 * probe)).determinant() > 0;
    if (upright) needless.col(kept++) = x.col(probes * i);
  }
  return needless.leftCols(kept);
}

// Refines folds for as long as that leaves fewer of them. Where the map itself is nearly flat it does not:
// finer leaves bring rims of their own. Answers what still folds.
std::vector<FoldedCell> refine_folds(const ElasticMap& map, std::unique_ptr<PyramidBuilder>& builder,
                                     Bake& bake, const Progress& progress) {
  Certificate before = certify_listing_all(bake.pyramid, map.affine(), 1, progress);
  for (int round = 0; round < rounds_against_folds && before.places.size() <= most_mendable_folds; ++round) {
    const Points folds = needless_folds(map, bake.pyramid, before);
    if (folds.cols() == 0) break;
    auto refined = std::make_unique<PyramidBuilder>(*builder);
    if (refined->refine_at(folds) == 0) break;
    refined->refine();
    Pyramid pyramid = refined->pyramid();
    Certificate after = certify_listing_all(pyramid, map.affine(), 1, progress);
    if (after.places.size() >= before.places.size()) break;
    bake.summary.refined_folds += before.places.size() - after.places.size();
    bake.pyramid = std::move(pyramid);
    builder = std::move(refined);
    before = std::move(after);
  }
  return std::move(before.places);
}

// Repairs all folds or none: half a repair would cost accuracy and prove nothing.
void repair(const ElasticMap& map, const std::vector<FoldedCell>& folds, Bake& bake,
            const Progress& progress) {
  bake.summary.folded_cells = folds.size();
  if (folds.empty() || folds.size() > most_mendable_folds) return;
  Pyramid repaired = bake.pyramid;
  const RepairSummary summary = repair_folds(repaired, map.affine(), folds, progress);
  if (summary.folded > 0) return;
  bake.summary.folded_cells = 0;
  bake.summary.repaired_cells = folds.size();
  bake.summary.repair_cost = summary.largest_change;
  bake.pyramid = std::move(repaired);
}

Bake bake_adaptively(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  Stopwatch watch;
  auto builder = std::make_unique<PyramidBuilder>(
      map, RefinementOptions{options.tolerance, options.max_memory, options.precision}, progress);
  builder->refine();
  Bake result;
  BakeSummary& summary = result.summary;
  result.pyramid = builder->pyramid();
  summary.refine_seconds += watch.lap();
  Measurement measurement(map, builder->coarsest(), builder->band(), options, progress);
  const auto refine_worst = [&] {
    summary.measure_seconds += watch.lap();
    const bool refined = builder->refine_at(measurement.worst()) > 0;
    if (refined) builder->refine();
    if (refined) result.pyramid = builder->pyramid();
    summary.refine_seconds += watch.lap();
    return refined;
  };
  // Around what a sample has found, until nothing more is. Where voxels are as small as they get, the worst
  // points stay however often they are found.
  const auto refine_around_worst = [&] {
    double before = std::numeric_limits<double>::infinity();
    for (int round = 0; round < local_rounds; ++round) {
      const auto worst = static_cast<double>(measurement.worst().cols());
      if (worst == 0 || !(worst < most_left_by_a_round * before) || !refine_worst()) return round > 0;
      before = worst;
      measurement.near_worst(result.pyramid);
    }
    return true;
  };
  for (int round = 0; round < quick_rounds; ++round)
    if (measurement.quickly(result.pyramid) > options.tolerance) refine_around_worst();
  measurement.fully(result.pyramid, summary);
  for (int round = 1; round < full_rounds && summary.error.max > options.tolerance; ++round) {
    if (!refine_around_worst()) break;
    measurement.fully(result.pyramid, summary);
  }
  summary.measure_seconds += watch.lap();
  const std::vector<FoldedCell> folds = refine_folds(map, builder, result, progress);
  summary.evaluated_points = builder->evaluated_points();
  summary.peak_bytes = builder->byte_count();
  builder.reset();  // its memory serves the repair
  repair(map, folds, result, progress);
  summary.mend_seconds += watch.lap();
  if (summary.refined_folds > 0 || summary.repaired_cells > 0) measurement.fully(result.pyramid, summary);
  summary.measure_seconds += watch.lap();
  return result;
}

}  // namespace

std::string to_string(const BakeSummary& summary) {
  std::size_t leaves = 0;
  std::size_t voxels = 0;
  for (const BakeLevelSummary& level : summary.levels) {
    leaves += level.leaves;
    voxels += level.voxels;
  }
  char text[400];
  std::snprintf(
      text, sizeof text,
      "%zu levels, finest voxel %.4g, %zu leaves, %zu voxels; error p99 %.4g max %.4g (n = %zu), tolerance "
      "%s; %zu folds refined, %zu cells repaired by at most %.2g, %zu still folded; %.2f s (refine %.2f, "
      "measure %.2f, mend %.2f)",
      summary.levels.size(), summary.levels.empty() ? 0.0 : summary.levels.back().voxel_size, leaves, voxels,
      summary.error.p99, summary.error.max, summary.error.count, summary.tolerance_met ? "met" : "not met",
      summary.refined_folds, summary.repaired_cells, summary.repair_cost, summary.folded_cells,
      summary.seconds, summary.refine_seconds, summary.measure_seconds, summary.mend_seconds);
  return text;
}

Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  const Stopwatch watch;
  if (!(options.tolerance > 0 && std::isfinite(options.tolerance)))
    throw InvalidInput("bake tolerance " + std::to_string(options.tolerance) + " is not positive and finite");
  if (options.voxel_size && !(*options.voxel_size > 0 && std::isfinite(*options.voxel_size)))
    throw InvalidInput("voxel size " + std::to_string(*options.voxel_size) + " is not positive and finite");
  Bake result;
  if (!is_empty(map.support()))
    result = options.voxel_size ? bake_uniform(map, *options.voxel_size, options, progress)
                                : bake_adaptively(map, options, progress);
  BakeSummary& summary = result.summary;
  for (const PyramidLevel& level : result.pyramid.levels)
    summary.levels.push_back({level.voxel_size, level.leaves.size(), level.leaves.size() * leaf_nodes});
  summary.tolerance_met = summary.error.max <= options.tolerance;
  summary.seconds = watch.seconds();
  return result;
}

}  // namespace bespoke
