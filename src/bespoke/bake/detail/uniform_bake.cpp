#include "bespoke/bake/detail/uniform_bake.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "bespoke/bake/band.h"
#include "bespoke/bake/detail/face_turns.h"
#include "bespoke/bake/detail/measurement.h"
#include "bespoke/bake/error_points.h"
#include "bespoke/bake/pyramid/leaf_samples.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/error.h"
#include "bespoke/mapping/affine_map.h"
#include "bespoke/number_format.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// Memory and error of one uniform level, estimated before anything is allocated.
struct UniformEstimate {
  double voxel_size = 0;  // mesh units
  double bytes = 0;       // somewhat too many where there are millions of leaves
  double error = 0;       // expected largest trilinear error, mesh units
};

// Values, coordinates, and the index that the look-up needs (measured: 1.3 entries of 112 bytes a leaf).
constexpr std::size_t uniform_bytes_per_leaf = leaf_floats * sizeof(float) + 400;
// Points and values in flight, and the errors that are measured.
constexpr std::size_t uniform_fixed_bytes = std::size_t{24} << 20;

constexpr std::size_t error_probes = 4096;
// The largest of a few thousand probes falls short of the largest of all cells.
constexpr double probe_margin = 1.5;

// Before its frame.
double smallest_radius(const Support& support) {
  double radius = 0;
  for (const BallCloud& cloud : support.clouds)
    if (cloud.centers.cols() > 0 && cloud.radius > 0)
      radius = radius > 0 ? std::min(radius, cloud.radius) : cloud.radius;
  return radius / power_of_two_scale(support.frame);
}

// Too fine a lattice must be refused before its leaves are counted one by one: once a coarser one with the
// same origin has this many, the rest of the count is volume, up to the leaves at the level boundary.
double bytes_needed(const Support& support, const Lattice& lattice) {
  constexpr std::size_t enough_leaves = 4'000'000;
  const double extent = bounding_box(support).sizes().maxCoeff();
  int halvings = 0;
  while (std::ldexp(leaf_edge * lattice.voxel_size, halvings) < extent) ++halvings;
  std::size_t leaves = 0;
  for (; halvings >= 0; --halvings) {
    leaves = count_band_leaves(support, {lattice.origin, std::ldexp(lattice.voxel_size, halvings)});
    if (leaves >= enough_leaves) break;
  }
  return uniform_fixed_bytes +
         uniform_bytes_per_leaf * std::ldexp(static_cast<double>(leaves), 3 * std::max(halvings, 0));
}

// Largest |u − trilinear| at the centres of cells of this size around x, where it is largest to leading
// order.
double probe_error(const ElasticMap& map, const Points& x, double voxel_size) {
  Points nodes(3, 9 * x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    nodes.col(9 * i) = x.col(i);
    for (int corner = 0; corner < 8; ++corner)
      nodes.col(9 * i + 1 + corner) =
          x.col(i) + voxel_size * (as_vector(corner_step(corner)) - Vector3::Constant(0.5));
  }
  const Points u = map.displacement(nodes);
  double error = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    error = std::max(error, (u.middleCols(9 * i + 1, 8).rowwise().mean() - u.col(9 * i)).norm());
  return error;
}

std::string short_number(double value) { return format_number(value, 4); }

UniformEstimate estimate_uniform(const ElasticMap& map, const Lattice& lattice) {
  const Support support = map.support();
  UniformEstimate estimate;
  estimate.voxel_size = lattice.voxel_size;
  require_lattice(support, lattice);
  estimate.bytes = bytes_needed(support, lattice);
  const Lattice coarse{lattice.origin, std::max(lattice.voxel_size, smallest_radius(support) / leaf_edge)};
  const Points x = random_points(coarse, band_leaves(support, coarse), error_probes, 1);
  estimate.error = probe_margin * probe_error(map, x, lattice.voxel_size);
  return estimate;
}

void require_memory(const ElasticMap& map, const UniformEstimate& estimate, std::size_t max_memory) {
  const auto limit = static_cast<double>(max_memory);
  if (estimate.bytes <= limit) return;
  const auto megabytes = [](double bytes) {
    return std::to_string(static_cast<std::uint64_t>(std::ceil(bytes / 0x1p20))) + " MB";
  };
  std::string message = "voxels of " + short_number(estimate.voxel_size) + " need " +
                        megabytes(estimate.bytes) + ", the limit is " + megabytes(limit);
  const Support support = map.support();
  const Vector3 origin = bounding_box(support).min();
  double voxel_size = estimate.voxel_size;
  for (double needed = estimate.bytes; needed > limit; needed = bytes_needed(support, {origin, voxel_size})) {
    if (limit <= uniform_fixed_bytes + uniform_bytes_per_leaf || voxel_size > smallest_radius(support))
      throw MemoryLimitError(message + "; no voxel size fits, allow at least " +
                             megabytes(4 * uniform_fixed_bytes));
    voxel_size *= std::max(1.02, std::cbrt(needed / limit));
  }
  const double growth = voxel_size / estimate.voxel_size;
  throw MemoryLimitError(message + "; voxels of " + short_number(voxel_size) + " or a tolerance of " +
                         short_number(estimate.error * growth * growth) + " would fit");
}

}  // namespace

Bake bake_uniformly(const ElasticMap& map, double voxel_size, const BakeOptions& options,
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
  constexpr double however_thin = 0;
  result.summary.misoriented_faces =
      FaceTurns(map, options, however_thin).misoriented_faces(result.pyramid).size();
  result.summary.measure_seconds = watch.lap();
  // All voxels have the requested size: there are no finer leaves that could repair a fold.
  result.certificate = certify(result.pyramid, map.affine(), 1, progress);
  result.summary.repair_seconds = watch.lap();
  return result;
}

}  // namespace bespoke
