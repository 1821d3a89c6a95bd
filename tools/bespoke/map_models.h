#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/asset/asset.h"
#include "bespoke/batch/batch_job.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/page/fit_findings.h"
#include "bespoke/quality/mapping_quality.h"

namespace bespoke::command {

/// What subcommands that show a map take: the map, its two models, products, and what the fit found.
struct MapModelArguments {
  std::string map;
  std::string source;
  std::string target;
  std::vector<std::string> products;
  std::string unit;               ///< of the products' coordinates, where it is given
  std::optional<ModelPose> pose;  ///< of skinned products
  std::string confidence;
  std::string fit_report;
  bool untrusted = false;
};

void add_map_model_options(CLI::App& app, MapModelArguments& arguments);
void add_unit_option(CLI::App& app, std::string& unit);

/// A product's triangles and lines in the map's unit (product_scale), of a skinned one in that pose.
NamedProduct read_product_in(const std::string& path, const std::string& map_unit,
                             const std::string& given = "", ModelPose pose = ModelPose::shown);

std::vector<JobFile> inputs_of(const MapModelArguments& arguments);

struct MapModels {
  Asset asset;
  TriangleMesh source;
  TriangleMesh target;
  std::vector<NamedProduct> products;  ///< named by their files
  FitFindings findings;
};

/// Throws InvalidInput for models that the map was not made of, and whatever reading throws.
MapModels read_map_models(const MapModelArguments& arguments);

/// Refuses a model that the map was not made of: nothing that it says of the map would hold.
void require_source(const std::string& path, const TriangleMesh& source, const AssetRecord& record);
void require_target(const std::string& path, const TargetModel& target, const AssetRecord& record);

}  // namespace bespoke::command
