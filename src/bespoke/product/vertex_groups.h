#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bespoke/product/model_pose.h"

namespace bespoke {

/// For each vertex of the model in `path`, as read_model reads it in that pose, the name of the group that it
/// belongs to: an OBJ file's group or, without one, its object; a glTF node. Empty names where a vertex has
/// none, and for other formats. Throws FileError and FormatError.
std::vector<std::string> vertex_groups(const std::filesystem::path& path, ModelPose pose);

}  // namespace bespoke
