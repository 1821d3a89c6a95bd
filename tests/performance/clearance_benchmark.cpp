#include <benchmark/benchmark.h>

#include "asset/small_asset.h"
#include "bespoke/clearance/keep_clear.h"
#include "bespoke/clearance/model_sides.h"
#include "clearance/balls.h"

namespace bespoke {
namespace {

// 10,242 vertices and 20,480 faces around a body of as many.
constexpr int levels = 5;

// Of the radius: half a percent of the diagonal, as deep as maps take garments.
constexpr double depth = 0.0175;

Obstacle ball_by_look_up() {
  const TriangleMesh ball = test::shell(1, levels);
  const auto distances =
      model_distances(with_model_sides(with_preview(test::small_asset(), ball), ball, ball));
  return body_obstacle(distances, {diagonal(ball.vertices), diagonal(ball.vertices)}, {});
}

void PrepareProduct(benchmark::State& state) {
  const TriangleMesh product = test::shell(1.02, levels);
  for (auto _ : state) benchmark::DoNotOptimize(PreparedProduct(product));
}

/// range(0): hundredths of a radian around the pole that were pushed in.
void KeepClear(benchmark::State& state) {
  const Obstacle ball = ball_by_look_up();
  const TriangleMesh product = test::shell(1.02, levels);
  const PreparedProduct prepared(product);
  const Points carried = test::dented(product.vertices, 0.01 * static_cast<double>(state.range(0)), depth);
  double solve = 0, check = 0, moved = 0;
  for (auto _ : state) {
    const ClearanceSummary summary = keep_clear(prepared, carried, {ball}).summary;
    solve += 1e3 * summary.solve_seconds;
    check += 1e3 * summary.check_seconds;
    moved = static_cast<double>(summary.moved);
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["correction_ms"] = solve / runs;
  state.counters["check_ms"] = check / runs;
  state.counters["moved"] = moved;
}

BENCHMARK(PrepareProduct)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(KeepClear)->Arg(30)->Arg(100)->Arg(310)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace bespoke
