#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/apply/chord_error.h"
#include "bespoke/product/model_pose.h"
#include "bespoke/product/rigid_part.h"
#include "bespoke/progress.h"

namespace bespoke {

struct ProductSummary {
  ApplySummary points;                ///< its seconds are those of reading, look-up and writing
  std::vector<std::string> warnings;  ///< what the file holds that was left as it is, a sentence each
  std::vector<std::filesystem::path> companions;  ///< written besides the outputs: buffers beside a .gltf
  std::vector<PartSummary> parts;                 ///< that kept their shape
  std::optional<ChordError> chord;                ///< at the last time, where it was requested
  std::size_t splits = 0;                         ///< edges that were split for it
  std::size_t joints = 0;  ///< of a skeleton that was carried, or that the product was bound to
};

struct ApplyToProductOptions {
  MotionOptions motion;
  std::vector<RigidPart> parts;  ///< that keep their shape
  /// Split edges until the chord error of the last time is at most this, mesh units (refine_product), where
  /// the file's kind can (can_split_product). The summary then has the chord error.
  std::optional<double> refine;
  /// The summary has the chord error of the last time. The faces are read for it once more, by read_product;
  /// a warning says where they cannot be.
  bool measure_chords = false;
  /// Of the model that products are around: a product far from it is refused if it looks as if it were in
  /// another unit (unit_check.h), with nothing written.
  std::optional<Box> model_box;
  Progress progress;
  ModelPose pose = ModelPose::shown;  ///< of skinned meshes
  std::optional<std::filesystem::path> skeleton =
      std::nullopt;                 ///< that the product is bound to (CarryOptions)
  std::vector<double> times = {1};  ///< of the outputs, one each
};

/// Carries the product `input` across a mapping: one file for every time, of the kind of the input, in which
/// positions, normals and tangents are those of Ψ(t), but of parts that keep their shape, and all else is as
/// it was (carry_product). Many times cost one look-up. All files are written, or none is left. Throws as
/// carry_product and apply_mapping.
ProductSummary apply_to_product(const std::filesystem::path& input,
                                const std::vector<std::filesystem::path>& outputs, const ElasticMap& elastic,
                                const RigidTransform& target_from_source,
                                const ApplyToProductOptions& options = {});

}  // namespace bespoke
