// The five examples of the paper's Table I, stage by stage and method by method: seconds are the counters
// that end in _s. The paper's own seconds are not to hand, so they are not printed beside them.
#include <benchmark/benchmark.h>

#include <map>
#include <string>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/error.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/pipeline/make_map.h"
#include "samples.h"

namespace bespoke {
namespace {

const Sample& sample(const std::string& name) {
  static std::map<std::string, Sample> made;
  const auto found = made.find(name);
  return found != made.end() ? found->second : made.emplace(name, make_sample(name)).first->second;
}

void table_one(benchmark::State& state) {
  const Sample& example = sample(sample_names()[static_cast<std::size_t>(state.range(0))]);
  const SampleTarget& target = example.targets.back();
  MakeMapOptions options = default_options(diagonal(example.source.vertices));
  options.fit.surface_fit.method = surface_fits[static_cast<std::size_t>(state.range(1))].value;
  options.fit.elastic = elastic_methods[static_cast<std::size_t>(state.range(2))].value;
  state.SetLabel(example.name + " " + std::string(name_of(surface_fits, options.fit.surface_fit.method)) +
                 " " + std::string(name_of(elastic_methods, options.fit.elastic)));
  const Anchors anchors{"cm", target.anchors};
  try {
    for ([[maybe_unused]] auto iteration : state) {
      const FittedMapping fit = fit_mapping(example.source, target.mesh, anchors, options.fit);
      const Bake baked = bake(*fit.elastic, options.bake);
      const BakedMap map(fit.elastic->affine(), baked.pyramid);
      double apply_seconds = 0;
      std::size_t product_vertices = 0;
      for (const SampleProduct& product : example.products) {
        apply_seconds +=
            apply_mapping(map, fit.target_from_source, product.mesh.vertices, {1.0}).summary.seconds;
        product_vertices += static_cast<std::size_t>(product.mesh.vertices.cols());
      }
      state.counters["source"] = static_cast<double>(example.source.vertices.cols());
      state.counters["target"] = static_cast<double>(target.mesh.vertices.cols());
      state.counters["product"] = static_cast<double>(product_vertices);
      state.counters["surface_fit_s"] = fit.summary.surface->seconds;
      state.counters["elastic_s"] = fit.summary.elastic.seconds;
      state.counters["bake_s"] = baked.summary.seconds;
      state.counters["apply_s"] = apply_seconds;
      state.counters["voxels"] = static_cast<double>(baked.pyramid.voxel_count());
    }
  } catch (const Error& error) {
    state.SkipWithError(error.what());
  }
}

BENCHMARK(table_one)
    ->ArgsProduct({benchmark::CreateDenseRange(0, 4, 1),
                   {0, 1},
                   benchmark::CreateDenseRange(0, std::int64_t(elastic_methods.size()) - 1, 1)})
    ->Iterations(1)
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace bespoke
