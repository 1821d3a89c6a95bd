#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "bespoke/alignment/geodesic_counterparts.h"
#include "bespoke/mesh/cavities.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/quality/uncovered_area.h"
#include "bespoke/surface_fit/graph/anchor_geodesics.h"
#include "bespoke/surface_fit/surface_fit.h"
#include "support/pocketed_ball.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// A surface with bumps, about as far from the source as a coarse warp leaves it.
TriangleMesh bumpy_sphere(int levels) {
  TriangleMesh mesh = shapes::icosphere(levels);
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const Vector3 x = mesh.vertices.col(i);
    mesh.vertices.col(i) *= 1 + 0.03 * std::sin(4 * x.x()) * std::cos(3 * x.y()) + 0.01 * std::sin(9 * x.z());
  }
  return mesh;
}

/// 2,562 nodes onto 10,242, then 10,242 onto 40,962.
void fit(benchmark::State& state, SurfaceFitMethod method) {
  const auto levels = static_cast<int>(state.range(0));
  const TriangleMesh source = shapes::icosphere(levels);
  TriangleMesh target = bumpy_sphere(levels + 1);
  target.vertices =
      Eigen::AngleAxisd(0.3, Vector3(1, 2, 3).normalized()).toRotationMatrix() * target.vertices;
  const Eigen::VectorXd no_weights(0);
  SurfaceFitOptions options;
  options.method = method;
  SurfaceFit fit;
  for (auto _ : state)
    fit = fit_surface({source, source.vertices, target, Points(3, 0), Points(3, 0), no_weights}, options);
  state.counters["iterations"] = fit.summary.iterations;
  state.counters["nodes"] = static_cast<double>(source.vertices.cols());
  state.counters["distance_p95"] = fit.summary.after.p95;
}
BENCHMARK_CAPTURE(fit, laplacian, SurfaceFitMethod::laplacian)
    ->Arg(4)
    ->Arg(5)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK_CAPTURE(fit, deformation_graph, SurfaceFitMethod::deformation_graph)
    ->Arg(4)
    ->Arg(5)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// What every fit asks of a registered source of 10,242 vertices, and of four times as many: what of the
/// target it leaves bare.
void uncovered(benchmark::State& state) {
  const TriangleMesh target = shapes::icosphere(static_cast<int>(state.range(0)));
  const TriangleMesh registered = bumpy_sphere(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(uncovered_area(target, registered, 0.035));
}
BENCHMARK(uncovered)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// The same, of either model: what lines cavities. A ball with a pocket, 2,834 vertices, subdivided.
void cavities(benchmark::State& state) {
  TriangleMesh mesh = shapes::pocketed_ball();
  for (int level = 0; level < state.range(0); ++level) mesh = shapes::subdivided(mesh);
  for (auto _ : state) benchmark::DoNotOptimize(cavities_of(mesh));
  state.counters["vertices"] = static_cast<double>(mesh.vertices.cols());
}
BENCHMARK(cavities)->DenseRange(0, 3)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

/// What a pose asks of distances along both surfaces: their walks, the test of twenty or a hundred anchors,
/// and the pairs between them.
void anchor_geodesics(benchmark::State& state) {
  const auto levels = static_cast<int>(state.range(0));
  const TriangleMesh source = shapes::icosphere(levels), target = bumpy_sphere(levels);
  const std::vector<int> marked = spread_points(source.vertices, static_cast<std::size_t>(state.range(1)));
  const Points anchors = source.vertices(Eigen::all, marked), goals = target.vertices(Eigen::all, marked);
  const std::vector<double> inliers(marked.size(), 1);
  for (auto _ : state) {
    const AnchorGeodesics geodesics(source, target, anchors, goals, {});
    benchmark::DoNotOptimize(geodesics.left_out(inliers));
    benchmark::DoNotOptimize(geodesics.pairs(inliers));
  }
}
BENCHMARK(anchor_geodesics)
    ->ArgsProduct({{5, 6}, {20, 100}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Counterparts of places far from five pairs; and, with 36 pairs and nothing far from them, the one walk
/// over the source that every fit takes.
void counterparts(benchmark::State& state) {
  const auto levels = static_cast<int>(state.range(0));
  const Eigen::Index pairs = state.range(1);
  const TriangleMesh source = shapes::icosphere(levels), target = bumpy_sphere(levels);
  const Points from = source.vertices.leftCols(pairs), to = target.vertices.leftCols(pairs);
  CounterpartOptions options;
  if (pairs == 36) options.remote = 2;
  for (auto _ : state) benchmark::DoNotOptimize(geodesic_counterparts(source, target, {from, to}, options));
}
BENCHMARK(counterparts)
    ->ArgsProduct({{5, 6}, {5, 36}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace bespoke
