#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/progress.h"

namespace bespoke {

struct ProductSummary {
  ApplySummary points;                ///< its seconds are those of reading, look-up and writing
  std::vector<std::string> warnings;  ///< what the file holds that was left as it is, a sentence each
  std::vector<std::filesystem::path> companions;  ///< written besides the outputs: buffers beside a .gltf
};

/// Carries the product `input` across a mapping: one file for every time, of the kind of the input, in which
/// positions, normals and tangents are those of Ψ(t) and all else is as it was (carry_product). Many times
/// cost one look-up. All files are written, or none is left. Throws as carry_product and apply_mapping.
ProductSummary apply_to_product(const std::filesystem::path& input,
                                const std::vector<std::filesystem::path>& outputs, const ElasticMap& elastic,
                                const RigidTransform& target_from_source, const std::vector<double>& times,
                                const MotionOptions& motion = {}, const Progress& progress = {});

}  // namespace bespoke
