// A garment of 100,000 triangles in 20 curved pieces with 40 seams, from the mesh to the drawn sheet:
//   flatten_benchmark --benchmark_time_unit=ms
#include <benchmark/benchmark.h>

#include <cmath>
#include <numbers>

#include "bespoke/pattern/pattern_sheet.h"

namespace bespoke {
namespace {

/// A ring of cloth of these radii (millimetres), n × n quads, in 5 × 4 panels.
Garment ring(int n, double radius, double tube) {
  Garment garment;
  garment.path = "ring";
  garment.rule = PieceRule::groups;
  TriangleMesh& mesh = garment.mesh;
  mesh.vertices.resize(3, n * n);
  mesh.faces.resize(3, 2 * n * n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const double u = 2 * std::numbers::pi * i / n, v = 2 * std::numbers::pi * j / n;
      const double r = radius + tube * std::cos(v);
      mesh.vertices.col(i * n + j) << r * std::cos(u), tube * std::sin(v), r * std::sin(u);
      const int next = (i + 1) % n * n;
      mesh.faces.col(2 * (i * n + j)) << i * n + j, next + (j + 1) % n, next + j;
      mesh.faces.col(2 * (i * n + j) + 1) << i * n + j, i * n + (j + 1) % n, next + (j + 1) % n;
      const int panel = 4 * (5 * i / n) + 4 * j / n;
      garment.group_of_face.insert(garment.group_of_face.end(), 2, panel);
    }
  for (int panel = 0; panel < 20; ++panel)
    garment.group_names.push_back("panel " + std::to_string(panel + 1));
  return garment;
}

void FlattenTwentyPieces(benchmark::State& state) {
  const Garment garment = ring(224, 600, 100);
  FlatPattern pattern;
  for (auto _ : state) {
    pattern = flat_pattern(garment, nullptr);
    benchmark::DoNotOptimize(pattern_sheet(pattern));
  }
  state.counters["faces"] = static_cast<double>(garment.mesh.faces.cols());
  state.counters["pieces"] = static_cast<double>(pattern.pieces.size());
  state.counters["iterations"] = pattern.summary.iterations;
}
BENCHMARK(FlattenTwentyPieces)->Iterations(3)->UseRealTime();

}  // namespace
}  // namespace bespoke
