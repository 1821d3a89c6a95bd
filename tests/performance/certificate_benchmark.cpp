#include <benchmark/benchmark.h>

#include "bespoke/bake/bake.h"
#include "bespoke/certificate/certificate.h"
#include "support/analytic_map.h"

namespace bespoke {
namespace {

// Cells per second of one core: the time is what all threads together took.
void CertifyOneLevel(benchmark::State& state) {
  const AnalyticMap map({{Vector3::Zero(), 1.0, Vector3(0.1, 0.05, -0.02)}});
  BakeOptions options;
  options.tolerance = 1e-3;
  options.voxel_size = 0.0105;
  options.error_points = 1000;
  const Pyramid pyramid = bake(map, options).pyramid;
  Certificate certificate;
  for (auto _ : state) certificate = certify(pyramid, map.affine());
  state.counters["folded"] = static_cast<double>(certificate.folded);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * certificate.certified));
}

BENCHMARK(CertifyOneLevel)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace bespoke
