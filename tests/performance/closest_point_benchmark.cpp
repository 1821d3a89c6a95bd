#include <benchmark/benchmark.h>

#include <filesystem>
#include <random>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/mesh_io.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// Body d01 where the shared cases are present, else a sphere of as many faces.
struct Scene {
  TriangleMesh target;
  Points queries;  ///< as many as the source has vertices
  Points normals;  ///< at the queries
};

// `distance`: of the queries from the surface, as a fraction of the target's diagonal.
Scene scene(double distance) {
  const std::filesystem::path body = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases" / "d01_body_dress";
  const bool present = std::filesystem::exists(body / "reference_b.obj");
  Scene result;
  result.target = present ? read_triangle_mesh(body / "reference_b.obj") : shapes::icosphere(6);
  const TriangleMesh& mesh = result.target;
  const Points normals = face_normals(mesh);
  const double extent = diagonal(mesh.vertices);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::Index count = std::min<Eigen::Index>(13380, mesh.faces.cols());
  result.queries.resize(3, count);
  result.normals.resize(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index face = i * mesh.faces.cols() / count;
    result.normals.col(i) = normals.col(face);
    result.queries.col(i) = mesh.vertices.col(mesh.faces(0, face)) +
                            distance * extent * Vector3(uniform(random), uniform(random), uniform(random));
  }
  return result;
}

void closest(benchmark::State& state, double distance, bool compatible) {
  const Scene input = scene(distance);
  const ClosestPointTree tree(input.target);
  for (auto _ : state) {
    for (Eigen::Index i = 0; i < input.queries.cols(); ++i) {
      ClosestPointQuery query;
      if (compatible) query.normal = input.normals.col(i);
      benchmark::DoNotOptimize(tree.closest(input.queries.col(i), query));
    }
  }
  state.SetItemsProcessed(state.iterations() * input.queries.cols());
}

void build(benchmark::State& state) {
  const Scene input = scene(0);
  for (auto _ : state) benchmark::DoNotOptimize(ClosestPointTree(input.target));
  state.SetItemsProcessed(state.iterations() * input.target.faces.cols());
}

void move(benchmark::State& state) {
  const Scene input = scene(0);
  const ClosestPointTree tree(input.target);
  for (auto _ : state) benchmark::DoNotOptimize(tree.moved(input.target));
  state.SetItemsProcessed(state.iterations() * input.target.faces.cols());
}

BENCHMARK(build)->Unit(benchmark::kMillisecond);
BENCHMARK(move)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest, near, 0.002, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest, near_compatible, 0.002, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest, middle, 0.02, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest, middle_compatible, 0.02, true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest, far, 0.5, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(closest, far_compatible, 0.5, true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace bespoke
