#pragma once

#include <optional>
#include <string>

#include "bespoke/length.h"
#include "bespoke/pipeline/make_map.h"

namespace bespoke {

/// The options of a map, by the names of `bespoke fit`; what is empty or false is left to the
/// defaults. Lengths in percent are of the source's bounding-box diagonal: lambda and the voxel size, which
/// are measured around the source, of that itself, all others of the source scaled by a power of two
/// (default_options).
struct MapRequest {
  std::optional<SurfaceFitMethod> surface_fit;
  std::optional<BoundaryRule> boundaries;
  std::optional<double> max_stretch;  ///< > 1
  std::optional<ElasticMethod> elastic;
  std::optional<GuidedMaps> guides;
  std::optional<double> max_squeeze;  ///< > 1
  std::optional<RotationPath> path;
  std::optional<int> steps;  ///< > 0
  std::optional<Length> anchor_sigma;
  std::optional<Length> lambda;
  std::optional<Length> tolerance;
  std::optional<Length> fit_tolerance;
  std::optional<Length> voxel_size;
  std::optional<NodeValues> nodes;
  std::optional<Length> contact_offset;
  std::optional<std::uint64_t> max_memory;  ///< bytes
  bool keep_exact = false;
  bool half = false;
  bool strict = false;       ///< every vertex and the tolerance are met, whatever it takes: diffeomorphic
  bool as_given = false;     ///< models are not repaired (SurfaceFitOptions)
  bool any_size = false;     ///< models may be in two units (FitOptions)
  bool any_anchors = false;  ///< anchors may lie off their models (FitOptions)
  bool paper = false;        ///< the printed method; needs anchors
};

/// size_scale: see default_options.
MakeMapOptions make_options(const MapRequest& request, double source_diagonal, double size_scale = 1);

/// What comes with a request.
struct RequestInputs {
  bool anchors = false;      ///< pairs, curves or patches
  bool fitted = false;       ///< the source already registered to the target
  bool add_corners = false;  ///< corners of bounding boxes are to be added to the anchors
};

/// An option that cannot be supported: the methods requested know nothing of it, or what comes with it says
/// otherwise.
struct InapplicableOption {
  std::string name;  ///< of `bespoke fit`, without dashes in front
  std::string reason;
};

/// The first that there is.
std::optional<InapplicableOption> inapplicable_option(const MapRequest& request, const RequestInputs& inputs);

/// Gives the requested σ to the pairs without a given one; the printed method has exact anchors only.
void estimate_anchor_sigmas(Anchors& anchors, const MapRequest& request, double source_diagonal,
                            double size_scale = 1);

}  // namespace bespoke
