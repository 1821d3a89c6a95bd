#include <benchmark/benchmark.h>

#include "bespoke/mesh/closest_point.h"
#include "performance/closest_point_scene.h"

namespace bespoke {
namespace {

using closest_points::Scene;
using closest_points::scene;

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
