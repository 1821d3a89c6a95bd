#pragma once

#include <cstddef>

#include "bespoke/product/carry/product_file.h"
#include "bespoke/product/model_pose.h"

namespace bespoke {

/// Writes the .glb `product` bound to the skeleton of `target` (glTF): every vertex gets the weights of the
/// nearest place of the target's skinned meshes, which are as a viewer shows them, the product in `pose`:
/// barycentric means, of which the four largest are kept and normalised. The target's joints, with the nodes
/// above them, are appended; a skin and a skeleton of the product's own are left out. Returns the number of
/// joints. Throws FormatError naming the JSON pointer at fault, and InvalidInput for a target without a skin
/// and a product with buffers elsewhere.
std::size_t bind_gltf(const InputFile& product, const InputFile& target, ModelPose pose, OutputFile& output);

}  // namespace bespoke
