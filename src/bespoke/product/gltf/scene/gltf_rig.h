#pragma once

#include <vector>

#include "bespoke/product/gltf/scene/gltf_plan.h"
#include "bespoke/product/point_motion.h"

namespace bespoke {

/// What becomes of one node of a skeleton in one frame.
struct GltfCarriedNode {
  AffineMap scene_from_node;           ///< in the pose in which the meshes are carried
  Matrix3 turn = Matrix3::Identity();  ///< R̃: how it turns in the scene
  /// The same in its parent's frame: rotations r become turn · r.
  Matrix3 local_turn = Matrix3::Identity();
  /// Of translations t, which become `translation` + scale · shift_turn · (t − translation_before).
  Vector3 translation = Vector3::Zero(), translation_before = Vector3::Zero();
  double scale = 1;
  Matrix3 shift_turn = Matrix3::Identity();

  bool moves_translations() const;
};

/// The nodes of a skeleton in one frame.
struct GltfCarriedRig {
  std::vector<GltfCarriedNode> nodes;  ///< of all nodes of the file; those that are not rigged stay
  bool is_changed = false;
};

/// Joints through a motion Ψ: p ↦ Ψ(p) for the place of every rigged node, and R ↦ R̃ R for its rotation,
/// with R̃ the rotation of the polar decomposition of the mean of ∇Ψ over the vertices that it moves, by their
/// weights. What moves none takes the mean of all below it, or else ∇Ψ(p). Local scales stay. One rig a
/// frame. Throws FormatError naming the JSON pointer at fault.
std::vector<GltfCarriedRig> carry_rig(const GltfFile& file, const std::vector<GltfAccessor>& accessors,
                                      const GltfPlan& plan, const PointMotion& motion);

/// A joint's inverse bind matrix in a frame: from a mesh, which `scene_from_mesh` takes into the scene.
inline AffineMap carried_inverse_bind(const GltfCarriedNode& joint, const AffineMap& scene_from_mesh) {
  return composed(inverse_of(joint.scene_from_node), scene_from_mesh);
}

}  // namespace bespoke
