#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "bespoke/bake/bake.h"
#include "bespoke/bake/band.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

// A map that costs next to nothing to evaluate: what remains is the bake's own work.
void BakeOfACheapMap(benchmark::State& state) {
  const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, -0.02)}});
  BakeOptions options;
  options.tolerance = 1e-3;
  options.voxel_size = 0.0095;  // about 5 M voxels
  options.error_points = 1000;
  std::size_t voxels = 0;
  for (auto _ : state) voxels = bake(map, options).pyramid.voxel_count();
  state.counters["voxels"] = static_cast<double>(voxels);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * voxels));
}

// The same work for nested levels, by what their nodes hold.
void NestedBakeOfACheapMap(benchmark::State& state, NodeValues nodes) {
  const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, -0.02)}});
  BakeOptions options;
  options.tolerance = 2e-5;
  options.error_points = 1000;
  options.nodes = nodes;
  std::size_t voxels = 0;
  for (auto _ : state) voxels = bake(map, options).pyramid.voxel_count();
  state.counters["voxels"] = static_cast<double>(voxels);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * voxels));
}

// Small balls all over a sphere, as the finest layers of a map leave them.
void BandOfManySmallBalls(benchmark::State& state) {
  const Eigen::Index count = state.range(0);
  Support support;
  BallCloud cloud{Points(3, count), 2 / std::sqrt(static_cast<double>(count))};
  for (Eigen::Index i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double angle = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    const double radius = std::sqrt(1 - z * z);
    cloud.centers.col(i) << radius * std::cos(angle), radius * std::sin(angle), z;
  }
  support.clouds.push_back(cloud);
  for (auto _ : state) benchmark::DoNotOptimize(band_leaves(support, {Vector3::Zero(), cloud.radius / 8}));
  state.SetItemsProcessed(state.iterations() * count);
}

BENCHMARK(BandOfManySmallBalls)
    ->Arg(10'000)
    ->Arg(100'000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK(BakeOfACheapMap)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(NestedBakeOfACheapMap, sampled, NodeValues::sampled)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();
BENCHMARK_CAPTURE(NestedBakeOfACheapMap, balanced, NodeValues::balanced)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace bespoke
