#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/product/face_splits.h"
#include "bespoke/product/model_pose.h"
#include "bespoke/product/point_motion.h"
#include "bespoke/product/product_io.h"
#include "bespoke/product/rigid_part.h"
#include "bespoke/progress.h"

namespace bespoke {

struct CarrySummary {
  std::size_t points = 0;             ///< positions that were carried
  std::size_t directions = 0;         ///< normals and tangents that were carried
  std::vector<std::string> warnings;  ///< what the file holds that was left as it is, a sentence each
  DegenerateFaces degenerate;         ///< of which one of these tells, by places in the file with split edges
  std::vector<std::filesystem::path> companions;  ///< written besides the outputs: buffers beside a .gltf
  std::vector<PartSummary> parts;                 ///< that kept their shape
  std::size_t joints = 0;  ///< of a skeleton that was carried, or that the product was bound to
};

struct CarryOptions {
  std::vector<RigidPart> parts;  ///< that keep their shape
  Progress progress;
  /// Edges that are split first, of the faces as read_product reads them. What the file says of the ends is
  /// said of the middle too, as their mean. Only where can_split_product. A glTF mesh that is not split alike
  /// wherever nodes show it becomes several; strips and fans become lists. Values that nothing refers to any
  /// longer leave the buffers that are in the file.
  const FaceSplits* splits = nullptr;
  ModelPose pose = ModelPose::shown;  ///< of skinned meshes, in which they are carried
  /// A skinned glTF model to whose skeleton the product, a .glb, is bound where its one frame takes it: each
  /// vertex by the weights of the nearest place of that model's skin. A skeleton of its own is left out.
  std::optional<std::filesystem::path> skeleton = std::nullopt;
};

/// Writes the file `input` once for every frame of the motion, with positions, normals (as cof(J) n) and
/// tangents (J t) moved, their lengths kept, and every other byte as it was; the endings must agree. Text
/// keeps its digits. The skeleton of a skinned glTF mesh goes with it: nodes, inverse binds, animations.
/// Points of the options' parts, and what lies at the same places, move with their part. Each output is
/// complete or untouched. Throws FileError, InvalidInput (ending, unknown part, images that do not fit),
/// FormatError naming line, byte or element, and what the motion throws.
CarrySummary carry_product(const std::filesystem::path& input,
                           const std::vector<std::filesystem::path>& outputs, const PointMotion& motion,
                           const CarryOptions& options = {});

/// For each of the places (3×n) of points of the product in `input`, as read_product reads it in the options'
/// pose, the number of the options' part that it belongs to, or -1. Throws as carry_product.
std::vector<int> parts_of_places(const std::filesystem::path& input, const Points& places,
                                 const CarryOptions& options);

/// Of these parts those that the product has. Throws as parts_of_places, except for unknown parts.
std::vector<RigidPart> parts_present(const std::filesystem::path& input, const std::vector<RigidPart>& parts,
                                     ModelPose pose = ModelPose::shown);

/// Whether the ending of the name is that of a kind of product.
bool has_product_ending(const std::filesystem::path& path);

/// Whether edges can be split in a product with the ending of this name.
bool can_split_product(const std::filesystem::path& path);

/// The endings that are known, for messages: ".obj, .ply, … or .xyz".
std::string product_endings();

}  // namespace bespoke
