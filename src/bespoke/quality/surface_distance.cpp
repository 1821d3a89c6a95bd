#include "bespoke/quality/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/quality/detail/surface_samples.h"

namespace bespoke {
namespace {

constexpr std::size_t grain = 256;  // queries

std::vector<double> sampled_distances(const TriangleMesh& mesh, const ClosestPointTree& surface,
                                      std::size_t samples) {
  const SurfaceSamples on_mesh = sample_surface(mesh, samples);
  if (on_mesh.faces.empty()) throw InvalidInput("cannot sample a surface without area");
  return distances(positions(on_mesh, mesh), surface);
}

double largest(const std::vector<double>& values) { return *std::max_element(values.begin(), values.end()); }

}  // namespace

std::vector<double> distances(const Points& points, const ClosestPointTree& surface) {
  std::vector<double> result(static_cast<std::size_t>(points.cols()));
  parallel_for(result.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      result[i] = std::sqrt(surface.closest(points.col(static_cast<Eigen::Index>(i)))->squared_distance);
  });
  return result;
}

SurfaceDistance surface_distance(const TriangleMesh& a, const TriangleMesh& b,
                                 const SurfaceDistanceOptions& options) {
  require_valid(a, "the first surface");
  require_valid(b, "the second surface");
  if (options.samples == 0) throw InvalidInput("surface distance needs at least one sample");
  const ClosestPointTree tree_of_a(a), tree_of_b(b);
  SurfaceDistance distance;
  distance.hausdorff =
      std::max(largest(distances(a.vertices, tree_of_b)), largest(distances(b.vertices, tree_of_a)));
  const std::vector<double> from_a = sampled_distances(a, tree_of_b, options.samples);
  const std::vector<double> from_b = sampled_distances(b, tree_of_a, options.samples);
  distance.hausdorff = std::max({distance.hausdorff, largest(from_a), largest(from_b)});
  distance.a_to_b = summarize(from_a);
  distance.b_to_a = summarize(from_b);
  return distance;
}

std::string to_string(const SurfaceDistance& distance) {
  char hausdorff[40];
  std::snprintf(hausdorff, sizeof hausdorff, "%.4g", distance.hausdorff);
  return "there " + to_string(distance.a_to_b) + "; back " + to_string(distance.b_to_a) + "; Hausdorff " +
         hausdorff;
}

}  // namespace bespoke
