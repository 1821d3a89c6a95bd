#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "bespoke/product/gltf/scene/gltf_plan.h"
#include "bespoke/product/point_motion.h"

namespace bespoke {

/// Values of an accessor in one frame.
struct GltfCarried {
  GltfValues values;
  bool is_changed = false;
};

/// From meshes into the scene once they are carried, where that is another map than before: one entry a place
/// of the plan.
using GltfCarriedPlaces = std::vector<std::optional<AffineMap>>;

/// Moves what a plan names. What it is given must outlive it.
class GltfCarrier {
 public:
  /// `places`: one list a frame, or none where all places stay.
  GltfCarrier(const GltfFile& file, const std::vector<GltfAccessor>& accessors, const GltfPlan& plan,
              const PointMotion& motion, std::vector<GltfCarriedPlaces> places = {})
      : file_(file), accessors_(accessors), plan_(plan), motion_(motion), places_(std::move(places)) {}

  /// One result a frame. Throws FormatError for vectors that are not finite, InvalidInput for those that are
  /// not afterwards.
  std::vector<GltfCarried> carry(const GltfTask& task) const;

 private:
  /// How points of a mesh move in one frame, in the mesh's coordinates.
  struct LocalMotion {
    Points images, jacobians;
  };

  /// What vectors `before`, from number `first` on, of the task's accessor become in every frame.
  std::vector<Points> carry_block(const GltfTask& task, const GltfValues& before, std::size_t first) const;
  std::vector<LocalMotion> local_motion(const Points& x, const GltfTask& task, std::size_t first) const;
  static Points carried(GltfRole role, const Points& values, const LocalMotion& motion);

  const GltfFile& file_;
  const std::vector<GltfAccessor>& accessors_;
  const GltfPlan& plan_;
  const PointMotion& motion_;
  std::vector<GltfCarriedPlaces> places_;
};

}  // namespace bespoke
