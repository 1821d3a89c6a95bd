#include "bespoke/bake/bake.h"

#include <cmath>
#include <cstdio>

#include "bespoke/bake/detail/adaptive_bake.h"
#include "bespoke/bake/detail/uniform_bake.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

bool is_empty(const Support& support) {
  for (const BallCloud& cloud : support.clouds)
    if (cloud.centers.cols() > 0) return false;
  return true;
}

/// The lattices of a map that is trilinear on them; half precision rounds them, and that is the error.
Bake stored_as_it_is(const BakedMap& map, const BakeOptions& options, const Progress& progress) {
  Bake result;
  result.pyramid = map.pyramid();
  std::vector<double> rounded;
  if (options.precision == ValuePrecision::half) {
    result.pyramid.precision = ValuePrecision::half;
    for (PyramidLevel& level : result.pyramid.levels) {
      const std::vector<float> before = level.values;
      round_values(level.values, options.tolerance, ValuePrecision::half);
      for (std::size_t i = 0; i + 2 < before.size(); i += 3)
        rounded.push_back(std::hypot(level.values[i] - before[i], level.values[i + 1] - before[i + 1],
                                     level.values[i + 2] - before[i + 2]));
    }
  }
  result.summary.error = summarize(std::move(rounded));
  result.certificate = certify(result.pyramid, map.affine(), 1, progress);
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
  if (summary.error.count == 0) {
    std::snprintf(text, sizeof text,
                  "%zu levels, finest voxel %.4g, %zu leaves, %zu voxels, stored as fitted; %.2f s",
                  summary.levels.size(), summary.levels.empty() ? 0.0 : summary.levels.back().voxel_size,
                  leaves, voxels, summary.seconds);
    return text;
  }
  std::snprintf(
      text, sizeof text,
      "%zu levels, finest voxel %.4g, %zu leaves, %zu voxels; error p99 %.4g max %.4g (n = %zu), tolerance "
      "%s; %zu folds refined, %zu cells repaired by at most %.2g, %zu still folded; %.2f s (refine %.2f, "
      "measure %.2f, repair %.2f)",
      summary.levels.size(), summary.levels.empty() ? 0.0 : summary.levels.back().voxel_size, leaves, voxels,
      summary.error.p99, summary.error.max, summary.error.count, summary.tolerance_met ? "met" : "not met",
      summary.refined_folds, summary.repaired_cells, summary.repair_cost, summary.folded_cells,
      summary.seconds, summary.refine_seconds, summary.measure_seconds, summary.repair_seconds);
  std::string line = text;
  if (summary.misoriented_faces > 0)
    line += "; " + std::to_string(summary.misoriented_faces) + " faces misoriented against the map";
  if (summary.relaxed.empty()) return line;
  std::snprintf(text, sizeof text, "; relaxed to %.4g in %zu regions, the worst around (%.4g, %.4g, %.4g)",
                summary.relaxed.front().error, summary.relaxed.size(),
                summary.relaxed.front().box.center().x(), summary.relaxed.front().box.center().y(),
                summary.relaxed.front().box.center().z());
  return line + text;
}

Bake bake(const ElasticMap& map, const BakeOptions& options, const Progress& progress) {
  const Stopwatch watch;
  if (!(options.tolerance > 0 && std::isfinite(options.tolerance)))
    throw InvalidInput("bake tolerance " + std::to_string(options.tolerance) + " is not positive and finite");
  if (options.voxel_size && !(*options.voxel_size > 0 && std::isfinite(*options.voxel_size)))
    throw InvalidInput("voxel size " + std::to_string(*options.voxel_size) + " is not positive and finite");
  if (!(options.max_face_turn > 0 && options.max_face_turn <= 180))
    throw InvalidInput("a largest turn of faces of " + std::to_string(options.max_face_turn) +
                       " degrees is not above 0 and at most 180");
  Bake result;
  const auto* on_lattices = dynamic_cast<const BakedMap*>(&map);
  if (is_empty(map.support()))
    result.certificate = certify(result.pyramid, map.affine(), 1, progress);
  else if (on_lattices != nullptr && !options.voxel_size)
    result = stored_as_it_is(*on_lattices, options, progress);
  else
    result = options.voxel_size ? bake_uniformly(map, *options.voxel_size, options, progress)
                                : bake_adaptively(map, options, progress);
  BakeSummary& summary = result.summary;
  summary.folded_cells = result.certificate.folded + result.certificate.undecided;
  for (const PyramidLevel& level : result.pyramid.levels)
    summary.levels.push_back({level.voxel_size, level.leaves.size(), level.leaves.size() * leaf_nodes});
  summary.tolerance_met = summary.error.max <= options.tolerance;
  summary.seconds = watch.seconds();
  return result;
}

}  // namespace bespoke
