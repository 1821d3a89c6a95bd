#include <benchmark/benchmark.h>

#include "bespoke/volume/bake.h"
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

BENCHMARK(BakeOfACheapMap)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace bespoke
