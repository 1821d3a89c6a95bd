// Prints, for every shared case, what the nested pyramid, its certificate and its inverse come to. Not a
// timed loop: each case is one run.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "bespoke/fitting/fit_mapping.h"
#include "bespoke/mesh/mesh_io.h"
#include "bespoke/volume/bake.h"
#include "bespoke/volume/band.h"
#include "bespoke/volume/certificate.h"
#include "bespoke/volume/inverse.h"
#include "bespoke/volume/sampling.h"

namespace bespoke {
namespace {

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// Largest error at x of one uniform level, formed point by point because the level itself would not fit.
double uniform_error(const ElasticMap& map, const Points& x, const Lattice& lattice) {
  Points corners(3, 8 * x.cols());
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 lower = ((x.col(i) - lattice.origin) / lattice.voxel_size).array().floor();
    for (int n = 0; n < 8; ++n)
      corners.col(8 * i + n) =
          lattice.origin + lattice.voxel_size * (lower + Vector3(n >> 2 & 1, n >> 1 & 1, n & 1));
  }
  const Points u = map.displacement(corners);
  const Points exact = map.displacement(x);
  double largest = 0;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Vector3 f = (x.col(i) - corners.col(8 * i)) / lattice.voxel_size;
    Vector3 sum = Vector3::Zero();
    for (int n = 0; n < 8; ++n)
      sum += (n & 4 ? f.x() : 1 - f.x()) * (n & 2 ? f.y() : 1 - f.y()) * (n & 1 ? f.z() : 1 - f.z()) *
             u.col(8 * i + n);
    largest = std::max(largest, (sum - exact.col(i)).norm());
  }
  return largest;
}

void print_case(const std::filesystem::path& directory) {
  const TriangleMesh source = read_triangle_mesh(directory / "reference_a.obj");
  const TriangleMesh target = read_triangle_mesh(directory / "reference_b.obj");
  const double length = diagonal(source.vertices);
  FitOptions fit_options;
  fit_options.surface_fit.method = SurfaceFitMethod::multiscale;
  fit_options.elastic = ElasticMethod::diffeomorphic;
  fit_options.lambda = 0.1 * length;
  fit_options.fit_tolerance = 1e-4 * length;
  const FittedMapping fit =
      fit_mapping(source, target, read_anchors(directory / "anchors.json"), fit_options);

  BakeOptions options;
  options.tolerance = 0.00025 * length;
  const Bake baked = bake(*fit.elastic, options);
  std::printf("%s\n  %s\n  %.2f MB;", directory.filename().c_str(), to_string(baked.summary).c_str(),
              static_cast<double>(baked.pyramid.byte_count()) / 1e6);
  for (const BakeLevelSummary& level : baked.summary.levels)
    std::printf(" %.4g: %zu", level.voxel_size, level.voxels);

  const BakedMap map(fit.elastic->affine(), baked.pyramid);
  const Support support = fit.elastic->support();
  const Points near_surface = points_in_cells_at(baked.pyramid, source.vertices, 100'000, 5);
  const std::vector<double> errors = displacement_errors(map, *fit.elastic, near_surface, {});
  const double error = *std::max_element(errors.begin(), errors.end());
  Lattice lattice{bounding_box(support).min(), baked.pyramid.levels.front().voxel_size};
  while (uniform_error(*fit.elastic, near_surface, lattice) > error) lattice.voxel_size /= std::sqrt(2.0);
  const auto uniform = static_cast<double>(count_band_leaves(support, lattice) * leaf_nodes);
  std::printf(
      "\n  one uniform level of the same error near the surface (%.3g): voxel %.3g, %.3g M voxels, %.0f "
      "times\n",
      error, lattice.voxel_size, uniform / 1e6, uniform / static_cast<double>(baked.pyramid.voxel_count()));

  const Certificate certificate = certify(baked.pyramid, map.affine());
  std::printf("  %s (%.1f M cells/s)\n", to_string(certificate).c_str(),
              static_cast<double>(certificate.certified) / certificate.seconds / 1e6);
  if (!certificate.is_bijection()) return;
  const PyramidLevel& coarsest = baked.pyramid.levels.front();
  const Points x = random_points({baked.pyramid.origin, coarsest.voxel_size}, coarsest.leaves, 1'000'000, 6);
  double start = seconds();
  const double round_trip = (PointwiseInverse(map)(map(x)) - x).colwise().norm().maxCoeff();
  std::printf("  pointwise inverse: largest round trip of 1 M band points %.2g of the finest voxel, %.2f s\n",
              round_trip / baked.pyramid.levels.back().voxel_size, seconds() - start);
  start = seconds();
  const InverseMap exact_back(map, fit.target_from_source);
  const Bake baked_back = bake(exact_back, options);
  const BakedMap back(exact_back.affine(), baked_back.pyramid);
  const Points returned = inverse(fit.target_from_source) * back(fit.target_from_source * map(x));
  std::printf("  baked inverse: %zu voxels, largest round trip %.3g (tolerance %.3g), %.2f s\n",
              baked_back.pyramid.voxel_count(), (returned - x).colwise().norm().maxCoeff(), options.tolerance,
              seconds() - start);
  const ComposedMap exact_both(map, fit.target_from_source, back);
  const Bake baked_both = bake(exact_both, options);
  const BakedMap both(exact_both.affine(), baked_both.pyramid);
  std::printf("  composed with it: %zu voxels, largest error %.3g\n", baked_both.pyramid.voxel_count(),
              (both(x) - exact_both(x)).colwise().norm().maxCoeff());
}

}  // namespace
}  // namespace bespoke

int main(int argc, char** argv) {
  const std::filesystem::path cases = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases";
  for (int i = 1; i < argc; ++i) bespoke::print_case(cases / argv[i]);
  if (argc > 1) return 0;
  if (!std::filesystem::is_directory(cases)) {
    std::printf("%s is not there: nothing to measure\n", cases.c_str());
    return 0;
  }
  for (const char* name : {"d00_similarity_head", "d01_body_dress", "d02_body_suit", "d03_head_glasses",
                           "d04_hand_glove", "d05_foot_shoe", "d06_head_hat", "d07_hard_toddler"})
    bespoke::print_case(cases / name);
}
