#include <benchmark/benchmark.h>

#include <cmath>

#include "bespoke/lattice/baked_map.h"

namespace bespoke {
namespace {

// Leaves that fill a cube of the given edge (in leaves) at every level; values that vary.
Pyramid full_cube(int level_count, int finest_edge) {
  Pyramid pyramid;
  for (int level = 0; level < level_count; ++level) {
    PyramidLevel filled;
    filled.voxel_size = std::ldexp(1.0, level_count - 1 - level);
    const int edge = finest_edge >> (level_count - 1 - level);
    for (int i = 0; i < edge; ++i)
      for (int j = 0; j < edge; ++j)
        for (int k = 0; k < edge; ++k) filled.leaves.push_back({i, j, k});
    filled.values.resize(3 * leaf_nodes * filled.leaves.size());
    for (std::size_t i = 0; i < filled.values.size(); ++i)
      filled.values[i] = static_cast<float>(std::sin(0.001 * static_cast<double>(i)));
    pyramid.levels.push_back(std::move(filled));
  }
  return pyramid;
}

// A walk along rows of points, as a scanned mesh or a subdivided surface is stored.
Points coherent_points(Eigen::Index count, double edge) {
  Points x(3, count);
  const auto side = static_cast<Eigen::Index>(std::cbrt(static_cast<double>(count))) + 1;
  for (Eigen::Index i = 0; i < count; ++i)
    x.col(i) = edge / static_cast<double>(side) *
               Vector3(static_cast<double>(i / side / side), static_cast<double>(i / side % side),
                       static_cast<double>(i % side));
  return x;
}

void Apply(benchmark::State& state, Eigen::Index count, bool coherent) {
  const int finest_edge = 16;
  const BakedMap map(AffineMap{}, full_cube(static_cast<int>(state.range(0)), finest_edge));
  const double edge = finest_edge * leaf_edge;
  const Points x =
      coherent ? coherent_points(count, edge) : Points((Points::Random(3, count).array() * 0.5 + 0.5) * edge);
  for (auto _ : state) benchmark::DoNotOptimize(map.displacement(x));
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * count);
}

void ApplyCoherent(benchmark::State& state) { Apply(state, 10'000'000, true); }
void ApplyRandom(benchmark::State& state) { Apply(state, 1'000'000, false); }

// Points per second of one core: the time is what all threads together took.
BENCHMARK(ApplyCoherent)->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
BENCHMARK(ApplyRandom)->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();

}  // namespace
}  // namespace bespoke
