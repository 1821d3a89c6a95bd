#include "bespoke/volume/bake.h"

#include <Eigen/LU>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "bespoke/error.h"
#include "bespoke/volume/baked_map.h"
#include "bespoke/volume/certificate.h"
#include "bespoke/volume/pyramid_builder.h"
#include "bespoke/volume/repair.h"
#include "bespoke/volume/sampling.h"
#include "bespoke/volume/uniform_bake.h"

namespace bespoke {
namespace {

constexpr std::uint64_t error_seed = 3;
// Places where a finished pyramid misses the tolerance or folds are refined and the whole measured anew.
constexpr int largest_number_of_rounds = 5;
constexpr int rounds_against_folds = 3;

bool is_empty(const Support& support) {
  for (const BallCloud& cloud : support.clouds)
    if (cloud.centers.cols() > 0) return false;
  return true;
}

Bake bake_uniform(const ElasticMap& map, double voxel_size, const BakeOptions& options,
                  const Progress& progress) {
  const Support support = map.support();
  const Lattice lattice{bounding_box(support).min(), voxel_size};
  const UniformEstimate estimate = estimate_uniform(map, lattice);
  require_memory(map, estimate, options.max_memory);

  Bake result;
  result.summary.peak_bytes = estimate.bytes;
  const std::vector<LeafCoordinates> leaves = band_leaves(support, lattice);
  PyramidLevel level = sample_level(map, lattice, leaves, progress);
  result.summary.evaluated_points = leaves.size() * leaf_nodes;
  result.pyramid.origin = lattice.origin;
  if (!level.leaves.empty()) result.pyramid.levels.push_back(std::move(level));

  const BakedMap baked(map.affine(), result.pyramid);
  const Points x = random_points(lattice, leaves, options.error_points, error_seed);
  result.summary.error = summarize(displacement_errors(baked, map, x, progress));
  return result;
}

// Points at which no decision of the builder was taken: random ones of the band, and near the surface, which
// the centres of the support lie on, 27 in each finest cell.
Points fresh_points(const PyramidBuilder& builder, const Pyramid& pyramid, const Support& support,
                    std::size_t count, std::uint64_t seed) {
  const Points random = random_points(builder.coarsest(), builder.band(), count, seed);
  Eigen::Index centers = 0;
  for (const BallCloud& cloud : support.clouds) centers += cloud.centers.cols();
  Points surface(3, centers);
  const Matrix3 inverse = support.frame.linear.inverse();
  Eigen::Index column = 0;
  for (const BallCloud& cloud : support.clouds)
    for (Eigen::Index i = 0; i < cloud.centers.cols(); ++i)
      surface.col(column++) = inverse * (cloud.centers.col(i) - support.frame.offset);
  const Points near_surface = points_in_cells_at(pyramid, surface, count, seed);
  Points all(3, random.cols() + near_surface.cols());
  all << random, near_surface;
  return all;
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

Points points_above(const Points& x, const std::vector<double>& errors, double tolerance) {
  Points above(3, x.cols());
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    if (!(errors[static_cast<std::size_t>(i)] <= tolerance)) above.col(kept++) = x.col(i);
  return above.leftCols(kept);
}

std::size_t cells_that_fail(const Certificate& certificate) {
  return certificate.folded + certificate.undecided;
}

// Refines folds for as long as that leaves fewer of them. Where the map itself is nearly flat it does not:
// finer leaves bring rims of their own.
void refine_folds(const ElasticMap& map, std::unique_ptr<PyramidBuilder>& builder, BakeSummary& summary,
                  const Progress& progress) {
  for (int round = 0; round < rounds_against_folds; ++round) {
    const Pyramid pyramid = builder->pyramid();
    const Certificate before = certify_listing_all(pyramid, map.affine(), 1, progress);
    const Points folds = needless_folds(map, pyramid, before);
    if (folds.cols() == 0) return;
    auto refined = std::make_unique<PyramidBuilder>(*builder);
    if (refined->refine_at(folds) == 0) return;
    refined->refine();
    const Certificate after = certify_listing_all(refined->pyramid(), map.affine(), 1, progress);
    if (cells_that_fail(after) >= cells_that_fail(before)) return;
    summary.refined_folds += cells_that_fail(before) - cells_that_fail(after);
    builder = std::move(refined);
  }
}

Bake bake_adaptively(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  const Support support = map.support();
  RefinementOptions refinement;
  refinement.tolerance = options.tolerance;
  refinement.max_memory = options.max_memory;
  auto builder = std::make_unique<PyramidBuilder>(map, refinement, progress);
  builder->refine();
  Bake result;
  BakeSummary& summary = result.summary;
  const auto errors_at = [&](const Points& x) {
    std::vector<double> errors =
        displacement_errors(BakedMap(map.affine(), result.pyramid), map, x, progress);
    summary.error = summarize(errors);
    return errors;
  };
  for (int round = 0;; ++round) {
    result.pyramid = builder->pyramid();
    const Points x = fresh_points(*builder, result.pyramid, support, options.error_points,
                                  error_seed + static_cast<std::uint64_t>(round));
    const std::vector<double> errors = errors_at(x);
    if (summary.error.max <= options.tolerance || round + 1 == largest_number_of_rounds) break;
    if (builder->refine_at(points_above(x, errors, options.tolerance)) == 0) break;
    builder->refine();
  }
  refine_folds(map, builder, summary, progress);
  if (summary.refined_folds > 0) result.pyramid = builder->pyramid();
  Pyramid repaired = result.pyramid;
  const RepairSummary repair = repair_folds(repaired, map.affine(), progress);
  if (repair.cells > 0 && repair.folded == 0) {
    summary.repaired_cells = repair.cells;
    summary.repair_cost = repair.largest_change;
    result.pyramid = std::move(repaired);
  } else {
    // Half a repair would cost accuracy and prove nothing.
    summary.folded_cells = repair.cells;
  }
  if (summary.refined_folds > 0 || summary.repaired_cells > 0)
    errors_at(fresh_points(*builder, result.pyramid, support, options.error_points,
                           error_seed + largest_number_of_rounds));
  summary.evaluated_points = builder->evaluated_points();
  summary.peak_bytes = builder->byte_count();
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
      "%s; %zu folds refined, %zu cells repaired by at most %.2g, %zu still folded; %.2f s",
      summary.levels.size(), summary.levels.empty() ? 0.0 : summary.levels.back().voxel_size, leaves, voxels,
      summary.error.p99, summary.error.max, summary.error.count, summary.tolerance_met ? "met" : "not met",
      summary.refined_folds, summary.repaired_cells, summary.repair_cost, summary.folded_cells,
      summary.seconds);
  return text;
}

Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
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
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace bespoke
