#pragma once

#include <array>

#include "bespoke/enum_names.h"

namespace bespoke {

/// Where the vertices of a skinned mesh (glTF) are.
enum class ModelPose {
  shown,   ///< where a viewer shows them: where its joints hold them as the nodes stand
  stored,  ///< where its node places what the file stores; if the joints hold it in its bind pose, as shown
};

inline constexpr std::array model_poses{Named<ModelPose>{"shown", ModelPose::shown},
                                        Named<ModelPose>{"stored", ModelPose::stored}};

}  // namespace bespoke
