#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/mapping/mapping.h"
#include "bespoke/product/model_pose.h"
#include "catalog_option.h"
#include "clearance_option.h"
#include "length_option.h"
#include "rigid_option.h"
#include "run_options.h"

namespace bespoke::command {

struct ApplyArguments {
  std::string map;
  CatalogOption catalog;
  std::vector<std::string> products;
  std::string output;
  std::string out_dir;
  std::string report;
  PartNames parts;
  std::optional<Length> refine;
  ClearanceOption clearance;
  std::string unit;
  std::optional<ModelPose> pose;
  std::string skeleton;
  double t = 1;
  std::optional<int> frames;
  std::optional<RotationPath> path;
  std::optional<MappingOrder> order;
  bool exact = false;
  bool inverse = false;
  bool untrusted = false;
  RunOptions run;
};

/// Whether the file is carried as it is, with its edges split where that is required.
bool is_carried(const ApplyArguments& arguments, const std::filesystem::path& product,
                const std::filesystem::path& output);

/// One list of frames a product. Throws CLI::ValidationError for arguments that contradict each other, and
/// UnknownEnding for kinds of files.
std::vector<std::vector<std::filesystem::path>> plan_outputs(const ApplyArguments& arguments);

}  // namespace bespoke::command
