#pragma once

#include <array>
#include <optional>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/product/gltf/scene/gltf_nodes.h"

namespace bespoke {

/// Which joints hold a point, and how much: weights sum to one, unused ones are zero at joint 0.
struct GltfPointWeights {
  std::array<std::size_t, 4> joints{};
  std::array<double, 4> weights{};
};

/// The skinned meshes of a file as one surface, and its skeleton.
class GltfTargetSkin {
 public:
  /// Throws FormatError naming the JSON pointer at fault, InvalidInput for a file without skinned triangles.
  explicit GltfTargetSkin(const InputFile& file);

  const std::vector<std::size_t>& joints() const { return joints_; }  ///< nodes, ascending
  /// Of every joint, as the file's nodes stand. Can be undone.
  const std::vector<AffineMap>& scene_from_joint() const { return scene_from_joint_; }
  /// The joints and the nodes above them, ascending, and how the file describes them.
  std::vector<std::size_t> nodes() const;
  const GltfJson& json() const { return file_.json; }
  const GltfHierarchy& hierarchy() const { return scene_.nodes; }

  /// Of the nearest place of the surface; x in the scene.
  GltfPointWeights weights_at(const Vector3& x) const;

 private:
  /// The weights of a primitive that is shown, whose joints are numbers of this skin's.
  struct Source {
    GltfWeights weights;
    std::vector<std::size_t> joints;
  };
  struct Corner {
    std::size_t source = 0, vertex = 0;
  };

  void read_joints();
  void read_surface();

  GltfFile file_;
  std::vector<GltfAccessor> accessors_;
  GltfScene scene_;
  std::vector<std::size_t> joints_;
  std::vector<AffineMap> scene_from_joint_;
  std::vector<Source> sources_;
  std::vector<Corner> corners_;  ///< three a face
  std::optional<ClosestPointTree> tree_;
};

}  // namespace bespoke
