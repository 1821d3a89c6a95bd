#include "bespoke/quality/mapping_quality.h"

#include "bespoke/error.h"

namespace bespoke {
namespace {

Statistics anchor_residuals(const MappingQualityInput& input) {
  if (input.anchor_sources.cols() != input.anchor_targets.cols())
    throw InvalidInput(std::to_string(input.anchor_sources.cols()) + " anchors on the source, but " +
                       std::to_string(input.anchor_targets.cols()) + " on the target");
  const Points mapped = input.target_from_source * input.elastic(input.anchor_sources);
  std::vector<double> residuals;
  for (Eigen::Index i = 0; i < mapped.cols(); ++i)
    residuals.push_back((mapped.col(i) - input.anchor_targets.col(i)).norm());
  return summarize(std::move(residuals));
}

}  // namespace

MappingQuality mapping_quality(const MappingQualityInput& input, const MappingQualityOptions& options,
                               const Progress& progress) {
  require_valid(input.source, "the source");
  require_valid(input.target, "the target");
  if (!input.carried_products.empty() && input.carried_products.size() != input.products.size())
    throw InvalidInput("places of " + std::to_string(input.carried_products.size()) + " products for " +
                       std::to_string(input.products.size()));
  MappingQuality quality;
  quality.anchor_residuals = anchor_residuals(input);
  progress.step("surfaces", 0, 1);
  const Points elastic_image = input.elastic(input.source.vertices);
  const TriangleMesh mapped{input.target_from_source * elastic_image, input.source.faces};
  quality.surfaces = surface_distance(mapped, input.target, options.surfaces);
  progress.step("surfaces", 1, 1);
  quality.distortion = map_distortion(input.elastic, options.distortion, progress);
  quality.source_faces = static_cast<std::size_t>(input.source.faces.cols());
  quality.flipped_faces = flipped_faces(input.source, elastic_image, input.elastic);
  if (input.products.empty()) return quality;

  const SignedDistance from_source(input.source), from_target(input.target);
  const Bodies bodies{input.source, input.target, from_source, from_target};
  for (const NamedProduct& product : input.products) {
    progress.step("products", quality.products.size(), input.products.size());
    try {
      const Points moved = input.carried_products.empty()
                               ? input.target_from_source * input.elastic(product.mesh.vertices)
                               : input.carried_products[quality.products.size()];
      quality.products.push_back(
          product_quality({product.mesh, product.line_edges}, moved, bodies, options.products));
    } catch (const InvalidInput& error) {
      throw InvalidInput(product.name + ": " + error.what());
    }
  }
  progress.step("products", input.products.size(), input.products.size());
  return quality;
}

}  // namespace bespoke
