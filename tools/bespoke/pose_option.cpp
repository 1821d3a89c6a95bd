#include "pose_option.h"

#include "name_option.h"

namespace bespoke::command {

void add_pose_option(CLI::App& app, std::optional<ModelPose>& pose, const std::string& what) {
  add_name_option(app, "--pose", pose, model_poses,
                  "Of " + what +
                      " whose nodes stand in another pose than they are stored in: shown, as viewers have "
                      "it, or stored, as in the file (default: shown)");
}

}  // namespace bespoke::command
