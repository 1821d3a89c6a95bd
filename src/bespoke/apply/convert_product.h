#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/apply/apply_to_product.h"

namespace bespoke {

struct ConvertOptions {
  MotionOptions motion;
  std::optional<double>
      refine;  ///< split edges until the chord error is at most this, mesh units (refine_product)
  bool measure_chords = false;      ///< the summary has a chord error in any case
  std::string unit;                 ///< of the product's coordinates, for 3MF; empty: what its file says
  std::optional<Box> model_box;     ///< as in ApplyToProductOptions
  std::vector<double> times = {1};  ///< of the outputs, one each
};

/// Carries the faces of a product across a mapping, which the outputs' endings say how to write: polygons and
/// OBJ's texture coordinates, nothing else (write_product). Edges are split for the last of the times. Throws
/// as read_product, write_product, refine_product and apply_mapping.
ProductSummary convert_product(const std::filesystem::path& input,
                               const std::vector<std::filesystem::path>& outputs, const ElasticMap& elastic,
                               const RigidTransform& target_from_source, const ConvertOptions& options = {});

}  // namespace bespoke
