#include "bespoke/pipeline/map_request.h"

#include <string>
#include <utility>

#include "bespoke/elastic/elastic_methods.h"
#include "bespoke/surface_fit/surface_fit_methods.h"

namespace bespoke {
namespace {

void use_printed_method(MakeMapOptions& options) {
  options.fit.surface_fit.method = SurfaceFitMethod::laplacian;
  options.fit.surface_fit.laplacian = no_additions;
  options.fit.surface_fit.repair_models = false;
  options.fit.elastic = ElasticMethod::csrbf;
  options.fit.guides = GuidedMaps::none;
  options.path = RotationPath::euler;
  options.fit.steps = 1;
  options.fit.contact_offset = 0;
  options.bake.nodes = NodeValues::sampled;
}

void set_lengths(const MapRequest& request, double source_diagonal, double size_scale,
                 MakeMapOptions& options) {
  const auto set = [](const std::optional<Length>& length, double diagonal, auto& value) {
    if (length) value = length->in_mesh_units(diagonal);
  };
  const double on_target = size_scale * source_diagonal;
  set(request.lambda, source_diagonal, options.fit.lambda);
  set(request.voxel_size, source_diagonal, options.bake.voxel_size);
  set(request.fit_tolerance, on_target, options.fit.fit_tolerance);
  set(request.contact_offset, on_target, options.fit.contact_offset);
  set(request.tolerance, on_target, options.bake.tolerance);
}

std::optional<InapplicableOption> against_inputs(const MapRequest& request, const RequestInputs& inputs) {
  if (request.paper && !inputs.anchors && !inputs.fitted)
    return InapplicableOption{"paper", "has no alignment without anchors, which are missing"};
  if (inputs.add_corners && !inputs.anchors)
    return InapplicableOption{"add-corners", "adds to the pairs of anchors, which are missing"};
  if (request.anchor_sigma && !inputs.anchors)
    return InapplicableOption{"anchor-sigma", "is of the pairs of anchors, which are missing"};
  const std::pair<const char*, bool> of_surface_fitting[] = {{"surface-fit", request.surface_fit.has_value()},
                                                             {"boundaries", request.boundaries.has_value()},
                                                             {"max-stretch", request.max_stretch.has_value()},
                                                             {"as-given", request.as_given}};
  for (const auto& [option, is_given] : of_surface_fitting)
    if (is_given && inputs.fitted)
      return InapplicableOption{option, "belongs to the surface fitting, which a fitted source skips"};
  return std::nullopt;
}

std::optional<InapplicableOption> against_paper(const MapRequest& request) {
  if (!request.paper) return std::nullopt;
  const std::string reason = "the printed method (--paper) has its own";
  if (request.surface_fit) return InapplicableOption{"surface-fit", reason};
  if (request.elastic) return InapplicableOption{"elastic", reason};
  if (request.path) return InapplicableOption{"path", reason};
  return std::nullopt;
}

std::optional<InapplicableOption> unknown_to_elastic_method(const MapRequest& request, ElasticMethod method) {
  const bool elements = method == ElasticMethod::finite_elements;
  if (request.max_squeeze && !elements)
    return InapplicableOption{"max-squeeze", "bounds the elastic method finite-elements, no other"};
  if (request.strict && elements)
    return InapplicableOption{"strict",
                              "meets every vertex, which the elastic method finite-elements does not"};
  if (request.nodes && elements)
    return InapplicableOption{"nodes", "the elastic method finite-elements stores its own nodes"};
  return std::nullopt;
}

std::optional<InapplicableOption> unknown_to_methods(const MapRequest& request) {
  if (request.nodes == NodeValues::balanced && request.voxel_size)
    return InapplicableOption{"nodes", "one uniform level (--voxel-size) is always sampled"};
  const FitOptions fit = make_options(request, 1).fit;
  const ElasticMethodRow& elastic = elastic_method(fit.elastic);
  if (request.guides && fit.guides != GuidedMaps::none && !elastic.takes_guides)
    return InapplicableOption{"guides", "the elastic method " + std::string(elastic.name) + " takes none"};
  if (std::optional<InapplicableOption> found = unknown_to_elastic_method(request, fit.elastic)) return found;
  if (fit.surface_fit.method == SurfaceFitMethod::deformation_graph) return std::nullopt;
  const std::string reason = "the surface fitting " +
                             std::string(name_of(surface_fits, fit.surface_fit.method)) +
                             " has no such option; deformation-graph has";
  if (request.boundaries) return InapplicableOption{"boundaries", reason};
  if (request.max_stretch) return InapplicableOption{"max-stretch", reason};
  return std::nullopt;
}

}  // namespace

MakeMapOptions make_options(const MapRequest& request, double source_diagonal, double size_scale) {
  MakeMapOptions options = default_options(source_diagonal, size_scale);
  if (request.paper) use_printed_method(options);
  if (request.surface_fit) options.fit.surface_fit.method = *request.surface_fit;
  if (request.as_given) options.fit.surface_fit.repair_models = false;
  options.fit.any_size = request.any_size;
  options.fit.any_anchors = request.any_anchors;
  if (request.boundaries) options.fit.surface_fit.boundaries = *request.boundaries;
  if (request.max_stretch) options.fit.surface_fit.max_stretch = *request.max_stretch;
  if (request.strict) options.fit.elastic = ElasticMethod::diffeomorphic;
  if (request.elastic) options.fit.elastic = *request.elastic;
  if (request.max_squeeze) options.fit.max_squeeze = *request.max_squeeze;
  if (request.guides) options.fit.guides = *request.guides;
  if (request.path) options.path = *request.path;
  if (request.steps) options.fit.steps = *request.steps;
  set_lengths(request, source_diagonal, size_scale, options);
  // Who names a tolerance wants that one.
  if (request.tolerance || request.strict) options.bake.max_leaves.reset();
  if (request.max_memory) options.fit.max_memory = options.bake.max_memory = *request.max_memory;
  if (request.nodes) options.bake.nodes = *request.nodes;
  if (request.half) options.bake.precision = ValuePrecision::half;
  options.keep_exact = request.keep_exact;
  return options;
}

std::optional<InapplicableOption> inapplicable_option(const MapRequest& request,
                                                      const RequestInputs& inputs) {
  using Found = std::optional<InapplicableOption>;
  if (Found found = against_inputs(request, inputs)) return found;
  if (Found found = against_paper(request)) return found;
  return unknown_to_methods(request);
}

void estimate_anchor_sigmas(Anchors& anchors, const MapRequest& request, double source_diagonal,
                            double size_scale) {
  if (!request.anchor_sigma && !request.paper) return;
  const double sigma =
      request.anchor_sigma ? request.anchor_sigma->in_mesh_units(size_scale * source_diagonal) : 0;
  for (AnchorPair& pair : anchors.pairs)
    if (has_no_given_sigma(pair)) pair.sigma = sigma;
}

}  // namespace bespoke
