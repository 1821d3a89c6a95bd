#include <benchmark/benchmark.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <vector>

#include "bespoke/elastic/multiscale.h"
#include "bespoke/elastic/space_guides.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/rigid/rigid_alignment.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

/// Source vertices, with their places on the target in the source frame.
struct Correspondences {
  Points sources;
  Points targets;
};

Points read_points(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::vector<double> coordinates;
  for (double value; file >> value;) coordinates.push_back(value);
  return Eigen::Map<const Points>(coordinates.data(), 3, Eigen::Index(coordinates.size() / 3));
}

/// A real pair of bodies where it is present, else a bent sphere; 13,380 pairs and, subdivided, four times as
/// many each time.
Correspondences load(int subdivisions) {
  const auto folder = std::filesystem::path(BESPOKE_SHARED_DIR) / "cases/d01_body_dress";
  if (!std::filesystem::exists(folder)) {
    Correspondences pairs;
    pairs.sources = test::sphere_points(13380 * (1 << (2 * subdivisions)));
    pairs.targets = pairs.sources + 0.1 * (3 * pairs.sources.array()).sin().matrix().colwise().reverse();
    return pairs;
  }
  TriangleMesh mesh = read_triangle_mesh(folder / "reference_a.obj");
  Correspondences pairs{mesh.vertices, read_points(folder / "gt_a_on_b.xyz")};
  const auto weights = Eigen::VectorXd::Ones(pairs.sources.cols());
  pairs.targets = inverse(align_rigidly(pairs.sources, pairs.targets, weights)) * pairs.targets;
  TriangleMesh moved{pairs.targets, mesh.faces};
  for (int k = 0; k < subdivisions; ++k) {
    mesh = shapes::subdivided(mesh);
    moved = shapes::subdivided(moved);
  }
  return {mesh.vertices, moved.vertices};
}

MultiscaleOptions options_for(const Points& sources, bool composed) {
  const double diagonal = (sources.rowwise().maxCoeff() - sources.rowwise().minCoeff()).norm();
  MultiscaleOptions options;
  options.lambda = 0.1 * diagonal;
  options.tolerance = 1e-4 * diagonal;
  options.composed = composed;
  return options;
}

/// Within λ of the sources, in no order.
Points band_points(const Points& sources, double lambda, int count) {
  std::mt19937 generator(1);
  std::uniform_int_distribution<Eigen::Index> pick(0, sources.cols() - 1);
  Points x = lambda / std::sqrt(3.0) * test::random_points(count, 2);
  for (auto point : x.colwise()) point += sources.col(pick(generator));
  return x;
}

void fit(benchmark::State& state) {
  const Correspondences pairs = load(int(state.range(0)));
  const MultiscaleOptions options = options_for(pairs.sources, state.range(1) != 0);
  MultiscaleSummary summary;
  for (auto _ : state) summary = fit_multiscale(pairs.sources, pairs.targets, options).summary;
  state.counters["vertices"] = double(pairs.sources.cols());
  state.counters["layers"] = double(summary.lambdas.size());
  state.counters["within_percent"] = 100.0 * double(summary.within_tolerance) / double(pairs.sources.cols());
}
BENCHMARK(fit)
    ->ArgNames({"subdivisions", "composed"})
    ->ArgsProduct({{0, 1, 2}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// CPU time of all threads counts, so the rate is one of points per core.
void evaluate(benchmark::State& state) {
  const Correspondences pairs = load(0);
  const MultiscaleOptions options = options_for(pairs.sources, state.range(0) != 0);
  const MultiscaleFit map = fit_multiscale(pairs.sources, pairs.targets, options);
  const Points x = band_points(pairs.sources, options.lambda, 1000000);
  for (auto _ : state) {
    if (state.range(1) != 0)
      benchmark::DoNotOptimize(map.map->displacement_gradient(x));
    else
      benchmark::DoNotOptimize(map.map->displacement(x));
  }
  state.counters["s/point"] = benchmark::Counter(
      double(x.cols()), benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(evaluate)
    ->ArgNames({"composed", "gradient"})
    ->ArgsProduct({{0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

/// Guides of 10,242 vertices, and of four times as many, as a step of a chain requires them.
void guides(benchmark::State& state) {
  const TriangleMesh source = shapes::icosphere(static_cast<int>(state.range(0)));
  const Points fitted = test::random_rotation(1) * source.vertices;
  SpaceGuides found;
  for (auto _ : state) found = space_guides(source, fitted, 0.35);
  state.counters["guides"] = static_cast<double>(found.sources.cols());
}
BENCHMARK(guides)->Arg(5)->Arg(6)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();

}  // namespace
}  // namespace bespoke
