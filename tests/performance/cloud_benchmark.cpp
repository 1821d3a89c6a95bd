#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "bespoke/cloud/point_cloud_surface.h"
#include "cloud/sampled_clouds.h"

namespace bespoke {
namespace {

// As scanners write points: noise in fractions of their spacing, normals tilted by some degrees.
constexpr double noise = 0.2;  // of the spacing
constexpr double tilt = 0.05;  // radians

void SurfaceOfANoisyTorus(benchmark::State& state) {
  const double area = 4 * std::numbers::pi * std::numbers::pi * 0.4;
  const double spacing = std::sqrt(area / double(state.range(0)));
  const OrientedPoints cloud =
      test::noisy(test::torus_cloud(state.range(0)), noise * spacing, tilt, /*seed=*/1);
  for (auto _ : state) benchmark::DoNotOptimize(point_cloud_surface(cloud, "torus"));
  state.SetItemsProcessed(state.iterations() * state.range(0));
}

BENCHMARK(SurfaceOfANoisyTorus)
    ->RangeMultiplier(10)
    ->Range(10'000, 1'000'000)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace bespoke
