#pragma once

#include <filesystem>

#include "bespoke/product/model_pose.h"
#include "bespoke/product/product_io.h"

namespace bespoke {

/// Reads as read_product, of a glTF file the skinned meshes in this pose. Throws as that, and InvalidInput
/// for skins that are stored in poses which contradict each other.
Product read_product(const std::filesystem::path& path, ModelPose pose);

/// The same of a model: of a glTF file its triangles alone, without lines.
Product read_model(const std::filesystem::path& path, ModelPose pose);

/// Whether the nodes of a glTF file show a skinned mesh in another pose than it is stored in. Throws as
/// read_product.
bool has_two_poses(const std::filesystem::path& path);

}  // namespace bespoke
