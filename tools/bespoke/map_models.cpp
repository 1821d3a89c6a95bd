#include "map_models.h"

#include <utility>

#include "bespoke/asset/asset_io.h"
#include "bespoke/error.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"
#include "commands.h"
#include "pose_option.h"

namespace bespoke::command {

void add_unit_option(CLI::App& app, std::string& unit) {
  app.add_option(
         "--unit", unit,
         "Unit of the products' coordinates: mm, cm, m, in …, or map for the map's own (default: what glTF "
         "and 3MF files say, else the map's)")
      ->type_name("UNIT");
}

void add_map_model_options(CLI::App& app, MapModelArguments& arguments) {
  app.add_option("MAP", arguments.map, map_help)->required();
  app.add_option("--source", arguments.source, "The source that the map was made of")
      ->required()
      ->type_name("MESH");
  app.add_option("--target", arguments.target, "The target that the map was made of")
      ->required()
      ->type_name("MESH");
  app.add_option("--product", arguments.products,
                 "Meshes or point sets around the source: " + read_product_endings())
      ->type_name("MESH");
  add_unit_option(app, arguments.unit);
  add_pose_option(app, arguments.pose, "skinned glTF products");
  app.add_option("--confidence", arguments.confidence, "What `fit --confidence-out` wrote")
      ->type_name("FILE");
  app.add_option("--fit-report", arguments.fit_report,
                 "What `fit --report` wrote: vertices that the map misses, and why")
      ->type_name("FILE");
  app.add_flag("--untrusted", arguments.untrusted, untrusted_help);
}

std::vector<JobFile> inputs_of(const MapModelArguments& arguments) {
  std::vector<JobFile> inputs{
      {"map", arguments.map}, {"source", arguments.source}, {"target", arguments.target}};
  for (const std::string& product : arguments.products) inputs.push_back({"product", product});
  for (JobFile& file :
       named_files({{"confidence", arguments.confidence}, {"fit-report", arguments.fit_report}}))
    inputs.push_back(std::move(file));
  return inputs;
}

MapModels read_map_models(const MapModelArguments& arguments) {
  MapModels models;
  models.asset = read_asset(arguments.map, {.untrusted = arguments.untrusted});
  const AssetRecord& record = models.asset.record;
  models.source = read_source(arguments.source, record.unit, record.source.hash);
  TargetModel target = read_target(arguments.target, record.unit, record.target.hash);
  require_source(arguments.source, models.source, models.asset.record);
  require_target(arguments.target, target, models.asset.record);
  models.target = std::move(target.mesh);
  for (const std::string& path : arguments.products) {
    models.products.push_back(
        read_product_in(path, record.unit, arguments.unit, arguments.pose.value_or(ModelPose::shown)));
  }
  if (!arguments.confidence.empty()) models.findings.confidence = read_confidence(arguments.confidence);
  if (!arguments.fit_report.empty()) models.findings.unmet = read_unmet_vertices(arguments.fit_report);
  return models;
}

NamedProduct read_product_in(const std::string& path, const std::string& map_unit, const std::string& given,
                             ModelPose pose) {
  const Product product = read_product(path, pose);
  return {std::filesystem::path(path).filename().string(),
          {product_scale(path, map_unit, given) * product.vertices, triangulated(product)},
          product.line_edges};
}

void require_source(const std::string& path, const TriangleMesh& source, const AssetRecord& record) {
  require_valid(source, path);
  if (content_hash(source) != record.source.hash)
    throw InvalidInput(path + ": is not the source that the map was made of (other vertices or faces)");
}

void require_target(const std::string& path, const TargetModel& target, const AssetRecord& record) {
  require_valid(target.mesh, path);
  if (content_hash(target) != record.target.hash)
    throw InvalidInput(path + ": is not the target that the map was made of (other vertices or faces)");
}

}  // namespace bespoke::command
