#include <benchmark/benchmark.h>

#include "bespoke/elastic/pffd.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// A product of 2,000 vertices just off a reference of 2,562 nodes, λ = 10 % of the diagonal.
void move_product(benchmark::State& state) {
  const TriangleMesh source = shapes::icosphere(4);
  Points fitted = source.vertices;
  fitted.row(2) *= 1.2;
  fitted.row(0).array() += 0.1 * source.vertices.row(1).array().square();
  const PffdMap map(source, fitted, 0.1 * diagonal(source.vertices));
  const Points product = 1.05 * test::sphere_points(2000);
  for (auto _ : state) benchmark::DoNotOptimize(map(product));
  state.counters["vertices"] = benchmark::Counter(static_cast<double>(product.cols() * state.iterations()),
                                                  benchmark::Counter::kIsRate);
}
BENCHMARK(move_product)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace bespoke
