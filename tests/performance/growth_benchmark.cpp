// What fitting two bodies costs as their meshes get finer: surface fitting and elastic map, source and target
// subdivided alike. `exponent` is p of cost ~ N^p since the row before. peak_GiB is that of the process so
// far, so run rows in order.
#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/make_map.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/report/report.h"
#include "samples.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

struct Bodies {
  TriangleMesh source;
  TriangleMesh target;
  Anchors anchors;
};

/// A real pair of bodies where it is present, else the generated mannequins.
Bodies load() {
  const auto folder = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases/d01_body_dress";
  if (std::filesystem::exists(folder))
    return {read_triangle_mesh(folder / "reference_a.obj"), read_triangle_mesh(folder / "reference_b.obj"),
            read_anchors(folder / "anchors.json")};
  const Sample dress = make_sample("dress");
  return {dress.source, dress.targets.back().mesh, {"cm", dress.targets.back().anchors}};
}

void fit_bodies(benchmark::State& state) {
  Bodies bodies = load();
  for (int level = 0; level < state.range(0); ++level) bodies.source = shapes::subdivided(bodies.source);
  // One level less: targets are meshed finer than sources here to begin with.
  for (int level = 0; level < state.range(0) - 1; ++level) bodies.target = shapes::subdivided(bodies.target);
  const FitOptions options = default_options(diagonal(bodies.source.vertices)).fit;
  FittedMapping fit;
  for (auto _ : state) fit = fit_mapping({bodies.source, bodies.target, bodies.anchors}, options);
  state.counters["source"] = double(bodies.source.vertices.cols());
  state.counters["target"] = double(bodies.target.vertices.cols());
  const double surface_fit = fit.summary.surface->seconds, elastic = fit.summary.elastic.seconds;
  state.counters["surface_fit_s"] = surface_fit;
  state.counters["elastic_s"] = elastic;
  state.counters["peak_GiB"] = double(peak_memory()) / (1 << 30);

  static double seconds_before = 0, vertices_before = 0;
  const double seconds = surface_fit + elastic, vertices = double(bodies.source.vertices.cols());
  if (seconds_before > 0)
    state.counters["exponent"] = std::log(seconds / seconds_before) / std::log(vertices / vertices_before);
  seconds_before = seconds;
  vertices_before = vertices;
}
BENCHMARK(fit_bodies)
    ->ArgName("subdivisions")
    ->DenseRange(0, 3)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace bespoke
