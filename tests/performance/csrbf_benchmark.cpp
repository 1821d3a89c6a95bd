#include <benchmark/benchmark.h>

#include "bespoke/elastic/csrbf.h"
#include "support/random_points.h"

namespace bespoke {
namespace {

Points bent(const Points& x) { return x + 0.1 * (3 * x.array()).sin().matrix().colwise().reverse(); }

/// Centres on a sphere, λ as a percentage of the bounding-box diagonal.
void fit(benchmark::State& state) {
  const Points sources = test::sphere_points(state.range(0));
  const Points targets = bent(sources);
  CsrbfOptions options;
  options.lambda =
      double(state.range(1)) / 100 * (sources.rowwise().maxCoeff() - sources.rowwise().minCoeff()).norm();
  CsrbfSummary summary;
  for (auto _ : state) summary = fit_csrbf(sources, targets, options).summary;
  state.counters["entries_per_row"] = summary.estimate.entries_per_row;
  state.counters["factor_entries"] = double(summary.estimate.factor_entries);
  state.counters["residual"] = summary.residual;
}
BENCHMARK(fit)
    ->ArgNames({"centres", "percent"})
    ->Args({2000, 10})
    ->Args({8000, 5})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void evaluate(benchmark::State& state) {
  const Points sources = test::sphere_points(2000);
  CsrbfOptions options;
  options.lambda = 0.1 * (sources.rowwise().maxCoeff() - sources.rowwise().minCoeff()).norm();
  const CsrbfFit map = fit_csrbf(sources, bent(sources), options);
  const Points x = test::sphere_points(200000) * 1.05;
  for (auto _ : state) benchmark::DoNotOptimize(map.map->displacement(x));
  state.counters["points/s"] =
      benchmark::Counter(double(x.cols()), benchmark::Counter::kIsIterationInvariantRate);
}
BENCHMARK(evaluate)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace bespoke
