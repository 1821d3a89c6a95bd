#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>

#include "bespoke/apply/apply_points.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/asset/asset_part.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/lattice/detail/brick_lookup.h"
#include "bespoke/parallel.h"
#include "lookup_rivals.h"

// Look-ups through all levels of a stored map: BESPOKE_MAP names the file, as `bespoke fit` writes it.

namespace bespoke {
namespace {

constexpr Eigen::Index coherent_count = 4'000'000;
constexpr Eigen::Index random_count = 1'000'000;
constexpr std::size_t points_per_chunk = 4096;

const Asset& asset() {
  static const Asset stored = [] {
    const char* path = std::getenv("BESPOKE_MAP");
    if (path == nullptr) throw std::runtime_error("set BESPOKE_MAP to a map that `bespoke fit` wrote");
    return read_asset(path);
  }();
  return stored;
}

const Pyramid& pyramid() { return asset().steps.front().pyramid; }

// A tenth wider than the source, so that a part lies outside the band, as of a product.
Box region() {
  Box box = asset().record.source.box;
  const Vector3 margin = 0.1 * box.sizes();
  return {box.min() - margin, box.max() + margin};
}

// A walk along rows of points, as a scanned mesh or a subdivided surface is stored.
Points coherent_points() {
  Points x(3, coherent_count);
  const auto side = static_cast<Eigen::Index>(std::cbrt(static_cast<double>(coherent_count))) + 1;
  for (Eigen::Index i = 0; i < x.cols(); ++i)
    x.col(i) = Vector3(static_cast<double>(i / side / side), static_cast<double>(i / side % side),
                       static_cast<double>(i % side)) /
               static_cast<double>(side);
  return region().sizes().asDiagonal() * x + region().min().replicate(1, x.cols());
}

Points random_points() {
  std::mt19937_64 engine(1);
  std::uniform_real_distribution<double> fraction(0, 1);
  const Points x = Points::NullaryExpr(3, random_count, [&] { return fraction(engine); });
  return region().sizes().asDiagonal() * x + region().min().replicate(1, x.cols());
}

const Points& points(bool coherent) {
  static const Points in_rows = coherent_points(), anywhere = random_points();
  return coherent ? in_rows : anywhere;
}

// Times look_up(x, count, u) over chunks of points, with one thread or as many as the argument says. Points
// per second of CPU time are those of one core; of wall-clock time, of all.
template <class LookUp>
void measure(benchmark::State& state, const LookUp& look_up, int threads = 1) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
  const Points& x = points(state.range(0) == 0);
  Points u = Points::Zero(3, x.cols());
  for (auto _ : state)
    parallel_for(static_cast<std::size_t>(x.cols()), points_per_chunk,
                 [&](std::size_t begin, std::size_t end) {
                   look_up(x.data() + 3 * begin, end - begin, u.data() + 3 * begin);
                 });
  benchmark::DoNotOptimize(u.data());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * x.cols());
  state.SetLabel(state.range(0) == 0 ? "in rows" : "in random order");
}

void measure_rival(benchmark::State& state, const std::shared_ptr<const LookUpRival>& rival) {
  if (rival == nullptr) return state.SkipWithError("not built with this library");
  measure(state, [&](const double* x, std::size_t count, double* u) { rival->look_up(x, count, u); });
}

const BrickAtlas& atlas() {
  static const std::optional<BrickAtlas> made = make_brick_atlas(pyramid());
  if (!made) throw std::runtime_error("this map has no atlas");
  return *made;
}

void look_up_chunk(const double* x, std::size_t count, double* u) {
  look_up(atlas(), {x, 3 * count}, {u, 3 * count});
}

void Atlas(benchmark::State& state) { measure(state, look_up_chunk, static_cast<int>(state.range(1))); }

void AtlasGradient(benchmark::State& state) {
  std::vector<double> gradient(9 * points_per_chunk);
  measure(state, [&](const double* x, std::size_t count, double*) {
    look_up_gradient(atlas(), {x, 3 * count}, std::span(gradient).first(9 * count));
  });
}

void Levels(benchmark::State& state) {
  static const BakedMap map({}, pyramid());
  measure(state, [&](const double* x, std::size_t count, double* u) {
    const Points at = Eigen::Map<const Points>(x, 3, static_cast<Eigen::Index>(count));
    Eigen::Map<Points>(u, 3, at.cols()) = map.displacement(at);
  });
}

void DenseArray(benchmark::State& state) {
  static const auto rival = dense_array(pyramid(), region());
  measure_rival(state, rival);
}

void OpenVdbBoxSampler(benchmark::State& state) {
  static const auto rival = openvdb_box_sampler(pyramid());
  measure_rival(state, rival);
}

void NanoVdbCachedSampler(benchmark::State& state) {
  static const auto rival = nanovdb_cached_sampler(pyramid());
  measure_rival(state, rival);
}

// The whole of the library's call: look-up, affine and rigid part, counts.
void ApplyPoints(benchmark::State& state) {
  static const ElasticChain map = loaded_chain(asset().steps);
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(1)));
  const Points& x = points(state.range(0) == 0);
  Points image(3, x.cols());
  const auto size = static_cast<std::size_t>(x.size());
  for (auto _ : state)
    apply_points(map, asset().target_from_source, {{x.data(), size}, {image.data(), size}});
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * x.cols());
  state.SetLabel(state.range(0) == 0 ? "in rows" : "in random order");
}

void MakeAtlas(benchmark::State& state) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(state.range(0)));
  std::size_t bytes = 0;
  for (auto _ : state) bytes = make_brick_atlas(pyramid())->byte_count();
  const auto value_bytes = static_cast<double>(sizeof(float) * leaf_floats * pyramid().leaf_count());
  state.counters["MB"] = 1e-6 * static_cast<double>(bytes);
  state.counters["of_values"] = static_cast<double>(bytes) / value_bytes;
}

void OpenMap(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(read_asset(std::getenv("BESPOKE_MAP")));
}

// What a ring requires: a twentieth of the source's extent about the middle of its box. Of a file that
// is not read in parts, nothing.
void OpenPart(benchmark::State& state) {
  const Box source = asset().record.source.box;
  const Vector3 half = source.sizes() / 40;
  const Box ring(source.center() - half, source.center() + half);
  for (auto _ : state) {
    std::optional<AssetPart> part = read_asset_part(std::getenv("BESPOKE_MAP"), ring);
    if (!part) return state.SkipWithError("the file is too small to be read in parts");
    state.counters["MB"] = 1e-6 * static_cast<double>(part->bytes_read);
    benchmark::DoNotOptimize(loaded_chain(std::move(part->steps)));
  }
}

void configure(benchmark::internal::Benchmark* benchmark) {
  benchmark->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->UseRealTime();
}
void one_thread(benchmark::internal::Benchmark* benchmark) {
  benchmark->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime();
}
void one_and_two_threads(benchmark::internal::Benchmark* benchmark) {
  for (const int order : {0, 1})
    for (const int threads : {1, 2}) benchmark->Args({order, threads});
  configure(benchmark);
}

BENCHMARK(Atlas)->Apply(one_and_two_threads);
BENCHMARK(AtlasGradient)->Apply(one_thread);
BENCHMARK(ApplyPoints)->Apply(one_and_two_threads);
BENCHMARK(Levels)->Apply(one_thread);
BENCHMARK(DenseArray)->Apply(one_thread);
BENCHMARK(OpenVdbBoxSampler)->Apply(one_thread);
BENCHMARK(NanoVdbCachedSampler)->Apply(one_thread);
BENCHMARK(MakeAtlas)->Arg(1)->Arg(2)->Apply(configure);
BENCHMARK(OpenMap)->Apply(configure);
BENCHMARK(OpenPart)->Apply(configure);

}  // namespace
}  // namespace bespoke
