#include "bespoke/elastic/elastic_methods.h"

#include <set>
#include <string>
#include <utility>

namespace bespoke {
namespace {

template <class Map, std::shared_ptr<const Map> (*read_map)(ExactMapReader&)>
constexpr StoredMapType stored(std::uint32_t number) {
  return {number, [](const ElasticMap& map) { return dynamic_cast<const Map*>(&map) != nullptr; },
          [](const ElasticMap& map, ExactMapWriter& writer) {
            write_exact(dynamic_cast<const Map&>(map), writer);
          },
          [](ExactMapReader& reader) -> std::shared_ptr<const ElasticMap> { return read_map(reader); }};
}

ElasticFit finite_elements(const ElasticInput& input, const ElasticOptions& options,
                           const Progress& progress) {
  FiniteElementOptions elements;
  elements.lambda = options.lambda;
  elements.fit_tolerance = options.fit_tolerance;
  elements.max_memory = options.max_memory;
  elements.affine_part = options.affine_part;
  elements.max_squeeze = options.max_squeeze;
  elements.max_nodes = options.max_nodes;
  elements.give_up_blocked = options.give_up_blocked;
  if (options.guided) elements.guides = space_guides(input.source, input.fitted, options.lambda);
  FiniteElementFit fit = fit_finite_elements(input.sources, input.targets, input.source, elements, progress);
  return {std::move(fit.map), std::move(fit.summary)};
}

ElasticFit csrbf(const ElasticInput& input, const ElasticOptions& options, const Progress& progress) {
  CsrbfOptions csrbf;
  csrbf.lambda = options.lambda;
  csrbf.max_memory = options.max_memory;
  CsrbfFit fit = fit_csrbf(input.sources, input.targets, csrbf, progress);
  return {std::move(fit.map), std::move(fit.summary)};
}

template <bool composed>
ElasticFit multiscale(const ElasticInput& input, const ElasticOptions& options, const Progress& progress) {
  MultiscaleOptions multiscale;
  const double growth = composed ? options.growth : 1;
  multiscale.lambda = growth * options.lambda;
  multiscale.tolerance = options.fit_tolerance;
  multiscale.composed = composed;
  multiscale.affine_part = options.affine_part;
  if (options.guided) {
    multiscale.guides = space_guides(input.source, input.fitted, options.lambda);
    multiscale.guides.offset *= growth;
  }
  MultiscaleFit fit = fit_multiscale(input.sources, input.targets, multiscale, progress);
  return {std::move(fit.map), std::move(fit.summary)};
}

std::size_t multiscale_layers(const ElasticMap& map) {
  return dynamic_cast<const MultiscaleMap&>(map).layers().size();
}

std::size_t multiscale_scales(const ElasticMap& map) {
  std::set<double> lambdas;
  for (const RbfLayer& layer : dynamic_cast<const MultiscaleMap&>(map).layers()) lambdas.insert(layer.lambda);
  return lambdas.size();
}

std::array<ElasticFit, 2> multiscale_halves(const ElasticFit& fit) {
  auto [first, second] =
      halves(dynamic_cast<const MultiscaleMap&>(*fit.map), std::get<MultiscaleSummary>(fit.found));
  return {
      {{std::move(first.map), std::move(first.summary)}, {std::move(second.map), std::move(second.summary)}}};
}

template <class Map>
ElasticFit pffd(const ElasticInput& input, const ElasticOptions& options, const Progress&) {
  return {std::make_shared<const Map>(input.source, input.fitted, options.lambda),
          PffdSummary{static_cast<std::size_t>(input.source.faces.cols())}};
}

}  // namespace

constinit const std::array<ElasticMethodRow, 6> elastic_methods{
    {{"finite-elements",
      ElasticMethod::finite_elements,
      finite_elements,
      true,
      true,
      true,
      true,
      10,
      2,
      {},
      stored<BakedMap, read_baked>(5)},
     {"csrbf",
      ElasticMethod::csrbf,
      csrbf,
      true,
      false,
      false,
      false,
      1,
      1,
      {},
      stored<CsrbfMap, read_csrbf>(1)},
     {"multiscale",
      ElasticMethod::multiscale,
      multiscale<false>,
      true,
      false,
      true,
      false,
      1,
      1,
      {},
      stored<MultiscaleMap, read_multiscale>(2)},
     {"diffeomorphic",
      ElasticMethod::diffeomorphic,
      multiscale<true>,
      true,
      true,
      true,
      false,
      1,
      1,
      {multiscale_layers, multiscale_scales, multiscale_halves},
      stored<MultiscaleMap, read_multiscale>(2)},
     {"pffd",
      ElasticMethod::pffd,
      pffd<PffdMap>,
      false,
      false,
      false,
      false,
      1,
      1,
      {},
      stored<PffdMap, read_pffd>(4)},
     {"pffd-smooth",
      ElasticMethod::pffd_smooth,
      pffd<SmoothPffdMap>,
      false,
      false,
      false,
      false,
      1,
      1,
      {},
      stored<SmoothPffdMap, read_pffd_smooth>(3)}}};

const ElasticMethodRow& elastic_method(ElasticMethod method) {
  for (const ElasticMethodRow& row : elastic_methods)
    if (row.value == method) return row;
  throw InvalidInput("elastic method " + std::to_string(static_cast<int>(method)) + " has no row");
}

}  // namespace bespoke
