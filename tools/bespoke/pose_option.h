#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "bespoke/product/model_pose.h"

namespace bespoke::command {

/// --pose, of `what`: "skinned glTF models".
void add_pose_option(CLI::App& app, std::optional<ModelPose>& pose, const std::string& what);

}  // namespace bespoke::command
