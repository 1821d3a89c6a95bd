#include "bespoke/volume/bake.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "bespoke/error.h"
#include "bespoke/volume/baked_map.h"
#include "bespoke/volume/sampling.h"
#include "bespoke/volume/uniform_bake.h"

namespace bespoke {
namespace {

constexpr std::uint64_t error_seed = 3;
constexpr int largest_number_of_bakes = 4;

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

Bake bake_to_tolerance(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  double voxel_size = uniform_voxel_size(map, options.tolerance);
  for (int bakes = 1;; ++bakes) {
    Bake result = bake_uniform(map, voxel_size, options, progress);
    const double error = result.summary.error.max;
    if (error <= options.tolerance || bakes == largest_number_of_bakes) return result;
    voxel_size *= std::sqrt(0.9 * options.tolerance / error);
  }
}

}  // namespace

std::string to_string(const BakeSummary& summary) {
  std::size_t leaves = 0;
  std::size_t voxels = 0;
  for (const BakeLevelSummary& level : summary.levels) {
    leaves += level.leaves;
    voxels += level.voxels;
  }
  char text[300];
  std::snprintf(
      text, sizeof text,
      "%zu levels, finest voxel %.4g, %zu leaves, %zu voxels; error p99 %.4g max %.4g (n = %zu), tolerance "
      "%s; %.2f s",
      summary.levels.size(), summary.levels.empty() ? 0.0 : summary.levels.back().voxel_size, leaves, voxels,
      summary.error.p99, summary.error.max, summary.error.count, summary.tolerance_met ? "met" : "not met",
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
                                : bake_to_tolerance(map, options, progress);
  BakeSummary& summary = result.summary;
  for (const PyramidLevel& level : result.pyramid.levels)
    summary.levels.push_back({level.voxel_size, level.leaves.size(), level.leaves.size() * leaf_nodes});
  summary.tolerance_met = summary.error.max <= options.tolerance;
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

}  // namespace bespoke
