// Prints, for every shared case, what the nested pyramid, its certificate and its inverse come to. Not a
// timed loop: each case is one run.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <utility>

#include "bespoke/bake/bake.h"
#include "bespoke/bake/band.h"
#include "bespoke/bake/error_points.h"
#include "bespoke/certificate/certificate.h"
#include "bespoke/certificate/inverse.h"
#include "bespoke/mapping/composed_map.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/product/mesh_io.h"

namespace bespoke {
namespace {

// Wall seconds, and those of all threads: on a busy machine the latter say what the work costs.
class Stopwatch {
 public:
  std::string lap() {
    const Reading now;
    char text[64];
    std::snprintf(text, sizeof text, "%.2f s (CPU %.2f s)", now.wall - last_.wall, now.cpu - last_.cpu);
    last_ = Reading();
    return text;
  }

 private:
  struct Reading {
    double wall = std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    double cpu = static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
  };
  Reading last_;
};

double megabytes(std::size_t voxels) { return static_cast<double>(voxels * 3 * sizeof(float)) / 1e6; }

double largest_distance(const Points& a, const Points& b) { return (a - b).colwise().norm().maxCoeff(); }

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

struct Pair {
  TriangleMesh source, target;
  Anchors anchors;
};

Pair turned(Pair pair) {
  std::swap(pair.source, pair.target);
  for (AnchorPair& anchor : pair.anchors.pairs) std::swap(anchor.a, anchor.b);
  return pair;
}

FittedMapping fit(const Pair& pair) {
  const double length = diagonal(pair.source.vertices);
  FitOptions options;
  options.surface_fit.method = SurfaceFitMethod::deformation_graph;
  options.elastic = ElasticMethod::diffeomorphic;
  options.lambda = 0.1 * length;
  options.fit_tolerance = 1e-4 * length;
  return fit_mapping({pair.source, pair.target, pair.anchors}, options);
}

void print_levels(const ElasticMap& exact, const Bake& baked, const TriangleMesh& source) {
  for (const BakeLevelSummary& level : baked.summary.levels)
    std::printf("    voxel %-8.4g %8zu voxels  %7.2f MB\n", level.voxel_size, level.voxels,
                megabytes(level.voxels));
  const BakedMap map(exact.affine(), baked.pyramid);
  const Points x = points_in_cells(baked.pyramid, finest_cells_on(baked.pyramid, source), 200'000, 5);
  const std::vector<double> errors = displacement_errors(map, exact, x, {});
  const double error = *std::max_element(errors.begin(), errors.end());
  const Support support = exact.support();
  Lattice lattice{bounding_box(support).min(), baked.pyramid.levels.front().voxel_size};
  while (uniform_error(exact, x, lattice) > error) lattice.voxel_size /= std::sqrt(2.0);
  const std::size_t uniform = count_band_leaves(support, lattice) * leaf_nodes;
  std::printf(
      "  %zu voxels, %.2f MB; one uniform level of the same error on the surface (%.3g): voxel %.3g, %.3g M "
      "voxels, %.0f MB: %.0f times\n",
      baked.pyramid.voxel_count(), megabytes(baked.pyramid.voxel_count()), error, lattice.voxel_size,
      static_cast<double>(uniform) / 1e6, megabytes(uniform),
      static_cast<double>(uniform) / static_cast<double>(baked.pyramid.voxel_count()));
}

void print_inverses(const BakedMap& map, const RigidTransform& target_from_source, const Points& x,
                    const BakeOptions& options) {
  Stopwatch watch;
  const double round_trip = largest_distance(PointwiseInverse(map)(map(x)), x);
  std::printf("  pointwise inverse: largest round trip of %ld band points %.2g of the finest voxel, %s\n",
              static_cast<long>(x.cols()), round_trip / map.pyramid().levels.back().voxel_size,
              watch.lap().c_str());
  const InverseMap exact_back(map, target_from_source);
  const Bake baked_back = bake(exact_back, options);
  const std::string time = watch.lap();
  const BakedMap back(exact_back.affine(), baked_back.pyramid);
  const Points returned = inverse(target_from_source) * back(target_from_source * map(x));
  std::printf("  baked inverse: %zu voxels, largest round trip %.3g (tolerance %.3g), %s\n",
              baked_back.pyramid.voxel_count(), largest_distance(returned, x), options.tolerance,
              time.c_str());
}

// a to b and then b to a, each fitted for itself: two maps that know nothing of one another.
void print_composition(const BakedMap& map, const RigidTransform& target_from_source, const Pair& pair,
                       const Points& x, const BakeOptions& options) {
  const FittedMapping inverse_fit = fit(turned(pair));
  const BakedMap back(inverse_fit.elastic->affine(), bake(*inverse_fit.elastic, options).pyramid);
  Stopwatch watch;
  const ComposedMap exact(map, target_from_source, back);
  const Bake baked = bake(exact, options);
  const std::string time = watch.lap();
  const BakedMap both(exact.affine(), baked.pyramid);
  const RigidTransform source_from_source = inverse_fit.target_from_source * target_from_source;
  const Points in_turn = inverse_fit.target_from_source * back(target_from_source * map(x));
  std::printf("  composed with the fitted way back: %zu voxels, largest error %.3g (tolerance %.3g), %s\n",
              baked.pyramid.voxel_count(), largest_distance(source_from_source * both(x), in_turn),
              options.tolerance, time.c_str());
}

void print_case(const std::filesystem::path& directory) {
  const Pair pair{read_triangle_mesh(directory / "reference_a.obj"),
                  read_triangle_mesh(directory / "reference_b.obj"),
                  read_anchors(directory / "anchors.json")};
  const FittedMapping fitted = fit(pair);
  BakeOptions options;
  options.tolerance = 0.00025 * diagonal(pair.source.vertices);
  options.nodes = NodeValues::sampled;  // as those of one level
  Stopwatch watch;
  BakeOptions with_surface = options;
  with_surface.surface = &pair.source;
  const Bake baked = bake(*fitted.elastic, with_surface);
  std::printf("%s\n  %s\n  bake %s\n", directory.filename().c_str(), to_string(baked.summary).c_str(),
              watch.lap().c_str());
  if (baked.pyramid.levels.empty()) return;
  print_levels(*fitted.elastic, baked, pair.source);

  const BakedMap map(fitted.elastic->affine(), baked.pyramid);
  watch.lap();
  const Certificate certificate = certify(baked.pyramid, map.affine());
  std::printf("  %s, %.1f M cells/s, %s\n", to_string(certificate).c_str(),
              static_cast<double>(certificate.certified) / certificate.seconds / 1e6, watch.lap().c_str());
  const PyramidLevel& coarsest = baked.pyramid.levels.front();
  const Points x = random_points({baked.pyramid.origin, coarsest.voxel_size}, coarsest.leaves, 1'000'000, 6);
  if (certificate.is_bijection()) print_inverses(map, fitted.target_from_source, x, options);
  print_composition(map, fitted.target_from_source, pair, x, options);
  std::fflush(stdout);
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
