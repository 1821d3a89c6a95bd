#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>

#include "bespoke/pipeline/map_request.h"
#include "bespoke/product/model_pose.h"
#include "run_options.h"

namespace bespoke::command {

struct FitArguments : MapRequest {
  std::string source;
  std::string target;
  std::string anchors;
  std::string output;
  std::string fitted;
  std::string fitted_out;
  std::string confidence_out;
  std::string report;
  std::string html;
  std::string unit;  ///< of the map, where it is given
  std::optional<ModelPose> pose;
  bool require_certified = false;
  bool add_corners = false;
  bool verbose = false;
  RunOptions run;
};

/// All arguments and options of `fit`, in the groups of its help.
void add_fit_options(CLI::App& fit, FitArguments& arguments);

}  // namespace bespoke::command
