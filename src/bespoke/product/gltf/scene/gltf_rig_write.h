#pragma once

#include <string>
#include <vector>

#include "bespoke/product/gltf/scene/gltf_frame.h"
#include "bespoke/product/gltf/scene/gltf_rig.h"

namespace bespoke {

/// Gives a frame the nodes, the inverse bind matrices and the animations of a carried rig: of a joint that
/// turns by C in its parent's frame, rotations become C r, and translations follow the length of the limb
/// (GltfCarriedNode). A skin that was in another pose than its meshes are stored in is bound in that pose, to
/// meshes in the scene's coordinates. All else of skins and animations stays. Throws FormatError naming the
/// JSON pointer at fault.
void write_rig(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfScene& scene,
               const GltfCarriedRig& rig, GltfFrame& frame);

/// What of the file's animations write_rig leaves though it may belong to the skeleton, a sentence each.
std::vector<std::string> rig_warnings(const GltfFile& file);

}  // namespace bespoke
