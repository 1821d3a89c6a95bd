#include "bespoke/elastic/multiscale.h"

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "bespoke/elastic/detail/exact_map_bytes.h"
#include "bespoke/rbf/layer_stack.h"

namespace bespoke {

struct MultiscaleMap::Evaluators {
  LayerStack stack;
};

namespace {

LayerStack stack_of(const std::vector<RbfLayer>& layers, bool composed) {
  std::vector<LayerEvaluator> evaluators;
  evaluators.reserve(layers.size());
  for (const RbfLayer& layer : layers)
    evaluators.emplace_back(layer.centers, layer.coefficients, layer.lambda, Wendland::c2);
  return {std::move(evaluators), composed ? Stacking::composed : Stacking::summed};
}

}  // namespace

MultiscaleMap::MultiscaleMap(AffineMap affine, std::vector<RbfLayer> layers, bool composed)
    : affine_(std::move(affine)),
      layers_(std::move(layers)),
      composed_(composed),
      evaluators_(new Evaluators{stack_of(layers_, composed)}) {}

MultiscaleMap::~MultiscaleMap() = default;

Points MultiscaleMap::displacement(const Points& x) const {
  return evaluators_->stack.displacement(composed_ ? affine_ * x : x);
}

Points MultiscaleMap::displacement_gradient(const Points& x) const {
  Points gradient = evaluators_->stack.gradient(composed_ ? affine_ * x : x);
  if (composed_)
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      gradient.middleCols<3>(3 * i) = (gradient.middleCols<3>(3 * i) * affine_.linear).eval();
  return gradient;
}

Support MultiscaleMap::support() const {
  // The first layer that moves a point finds it where the affine part left it, so the balls need no margin
  // for the motion by earlier layers.
  Support support;
  if (composed_) support.frame = affine_;
  for (const RbfLayer& layer : layers_) support.clouds.push_back({layer.centers, layer.lambda});
  return support;
}

std::string to_string(const MultiscaleSummary& summary) {
  std::size_t centers = 0;
  for (const std::size_t count : summary.centers) centers += count;
  double steepest = 0;
  for (const double bound : summary.gradient_bounds) steepest = std::max(steepest, bound);
  char text[320];
  std::snprintf(text, sizeof text, "%zu layers, %zu centres", summary.lambdas.size(), centers);
  std::string line = text;
  if (summary.residuals.count > 0) {
    std::snprintf(text, sizeof text, ", %zu of %zu vertices within tolerance, residual %s",
                  summary.within_tolerance, summary.residuals.count, to_string(summary.residuals).c_str());
    line += text;
  }
  if (!summary.gradient_bounds.empty()) {
    std::snprintf(text, sizeof text, ", every layer's gradient below %.3f", steepest);
    line += text;
  }
  std::snprintf(text, sizeof text, ", %.2f s", summary.seconds);
  return line + text;
}

std::vector<Figure> figures(const MultiscaleSummary& summary) {
  return {{"lambdas", summary.lambdas},
          {"centers", summary.centers},
          {"gradient_bounds", summary.gradient_bounds},
          {"within_tolerance", summary.within_tolerance}};
}

std::array<MultiscaleFit, 2> halves(const MultiscaleMap& map, const MultiscaleSummary& summary) {
  if (!map.composed() || map.layers().size() < 2)
    throw InvalidInput("a map of " + std::to_string(map.layers().size()) +
                       (map.composed() ? " composed" : " summed") + " layers has no halves");
  const auto middle = static_cast<std::ptrdiff_t>(map.layers().size() / 2);
  MultiscaleSummary first, second;
  const auto part = [&](auto MultiscaleSummary::*member) {
    const auto& all = summary.*member;
    (first.*member).assign(all.begin(), all.begin() + middle);
    (second.*member).assign(all.begin() + middle, all.end());
  };
  part(&MultiscaleSummary::lambdas);
  part(&MultiscaleSummary::centers);
  part(&MultiscaleSummary::gradient_bounds);
  second.residuals = summary.residuals;
  second.within_tolerance = summary.within_tolerance;
  second.seconds = summary.seconds;
  const auto layers = [&](auto begin, auto end) { return std::vector<RbfLayer>(begin, end); };
  const auto begin = map.layers().begin(), end = map.layers().end();
  return {{{std::make_shared<const MultiscaleMap>(map.affine(), layers(begin, begin + middle), true),
            std::move(first)},
           {std::make_shared<const MultiscaleMap>(AffineMap{}, layers(begin + middle, end), true),
            std::move(second)}}};
}

void write_exact(const MultiscaleMap& map, ExactMapWriter& writer) {
  writer.affine(map.affine());
  writer.integer(std::uint32_t{map.composed()});
  writer.count(static_cast<Eigen::Index>(map.layers().size()));
  for (const RbfLayer& layer : map.layers()) {
    writer.number(layer.lambda);
    writer.points(layer.centers);
    writer.points(layer.coefficients);
  }
}

std::shared_ptr<const MultiscaleMap> read_multiscale(ExactMapReader& reader) {
  const AffineMap affine = reader.affine();
  const auto composed = reader.integer<std::uint32_t>();
  if (composed > 1) reject_exact_map("neither composed nor summed");
  constexpr std::size_t smallest_layer = sizeof(double) + 2 * sizeof(std::uint64_t);
  std::vector<RbfLayer> layers(static_cast<std::size_t>(reader.count(smallest_layer, "layers")));
  for (RbfLayer& layer : layers) {
    layer.lambda = reader.positive("lambda");
    layer.centers = reader.points("centres");
    layer.coefficients = reader.points("coefficients");
    if (layer.centers.cols() != layer.coefficients.cols())
      reject_exact_map("as many coefficients as centres are needed");
  }
  reader.end();
  return std::make_shared<MultiscaleMap>(affine, std::move(layers), composed == 1);
}

}  // namespace bespoke
