#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/apply/unit_check.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/lattice/baked_map.h"
#include "bespoke/pipeline/open_map.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"
#include "bespoke/quality/mapping_quality.h"
#include "bespoke/report/quality_report.h"
#include "commands.h"
#include "corrected_products.h"
#include "help.h"
#include "map_models.h"
#include "output_files.h"
#include "pose_option.h"
#include "rigid_option.h"

namespace bespoke::command {
namespace {

struct MeasureArguments {
  std::string map;
  std::string output;
  std::string source;
  std::string target;
  std::vector<std::string> products;
  PartNames parts;
  ClearanceOption clearance;
  std::string unit;
  std::optional<ModelPose> pose;  ///< of skinned products
  bool json = false;
  bool exact = false;
  bool untrusted = false;
  RunOptions run;
};

std::vector<JobFile> inputs(const MeasureArguments& arguments) {
  std::vector<JobFile> files{
      {"map", arguments.map}, {"source", arguments.source}, {"target", arguments.target}};
  for (const std::string& product : arguments.products) files.push_back({"product", product});
  return files;
}

std::vector<JobFile> outputs(const MeasureArguments& arguments) {
  return named_files({{"output", arguments.output}});
}

std::vector<JobFigure> figures(const MappingQuality& quality) {
  return {{"source_to_target_p95", quality.surfaces.a_to_b.p95},
          {"target_to_source_p95", quality.surfaces.b_to_a.p95},
          {"hausdorff", quality.surfaces.hausdorff},
          {"flipped_faces", quality.flipped_faces}};
}

/// Opens the map again, as a carrier, where that is not where Ψ takes them.
CorrectedProducts as_apply_takes_them(const MeasureArguments& arguments,
                                      const std::vector<NamedProduct>& products) {
  const ModelPose pose = arguments.pose.value_or(ModelPose::shown);
  const ProductsAsWorn worn{arguments.products, arguments.unit, arguments.pose, arguments.clearance,
                            parts_of_products(arguments.products, arguments.parts, pose)};
  if (worn.is_as_mapped()) return {};
  return corrected_products(worn, products,
                            open_map(arguments.map, arguments.exact ? MapForm::exact : MapForm::grids,
                                     {.untrusted = arguments.untrusted}));
}

void run(const MeasureArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs(arguments), outputs(arguments));
  Asset asset = read_asset(arguments.map, {.untrusted = arguments.untrusted});
  const AssetRecord& record = asset.record;
  const TriangleMesh source = read_source(arguments.source, record.unit, record.source.hash);
  const TargetModel target = read_target(arguments.target, record.unit, record.target.hash);
  require_source(arguments.source, source, asset.record);
  require_target(arguments.target, target, asset.record);
  std::vector<NamedProduct> products;
  std::vector<std::string> names;
  for (const std::string& path : arguments.products) {
    const Product product = read_product(path, arguments.pose.value_or(ModelPose::shown));
    if (product.degenerate.count > 0)
      context.warn(path + ": " + to_string(product.degenerate), Entry::content_left_as_it_is);
    names.push_back(std::filesystem::path(path).filename().string());
    products.push_back(
        {path,
         {product_scale(path, record.unit, arguments.unit) * product.vertices, triangulated(product)},
         product.line_edges});
  }
  const auto anchors = static_cast<Eigen::Index>(asset.record.anchors.size());
  Points anchor_sources(3, anchors), anchor_targets(3, anchors);
  for (Eigen::Index i = 0; i < anchors; ++i) {
    anchor_sources.col(i) = asset.record.anchors[static_cast<std::size_t>(i)].a;
    anchor_targets.col(i) = asset.record.anchors[static_cast<std::size_t>(i)].b;
  }
  std::shared_ptr<const ElasticMap> elastic;
  if (arguments.exact)
    elastic = stored_exact_map(arguments.map, asset);
  else
    elastic = std::make_shared<ElasticChain>(baked_chain(std::move(asset.steps)));
  if (arguments.unit.empty())
    for (const NamedProduct& product : products)
      if (const std::string found =
              require_unit_of_map(product.name, product.mesh.vertices, *elastic, record.source.box);
          !found.empty())
        context.warn(product.name + ": " + found, Entry::content_left_as_it_is);
  const CorrectedProducts corrected = as_apply_takes_them(arguments, products);
  const MappingQuality quality = mapping_quality({source, target.mesh, *elastic, asset.target_from_source,
                                                  anchor_sources, anchor_targets, products, corrected.places},
                                                 {}, context.progress);
  context.findings.figures = figures(quality);
  write_result(arguments.output,
               arguments.json ? quality_json(quality, names, asset.record.unit)
                              : quality_text(quality, names, asset.record.unit),
               context);
  if (corrected.order) warn_of_layers(context, *corrected.order);
  for (std::size_t i = 0; i < corrected.found.size(); ++i)
    if (!corrected.found[i].is_clear())
      context.warn(products[i].name + ": " + what_is_not_clear(corrected.found[i].summary),
                   Entry::product_inside_the_target);
  for (std::size_t i = 0; i < products.size(); ++i)
    if (const NewPenetration& new_penetration = quality.products[i].new_penetration;
        new_penetration.is_notable())
      context.warn(products[i].name + ": " + to_string(new_penetration), Entry::product_inside_the_target);
}

}  // namespace

void add_measure_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<MeasureArguments>();
  CLI::App* measure = app.add_subcommand(
      "measure", "Measure a map and what it does to products: distances, distortion, clearance, penetration");
  begin_group(*measure, input_group);
  measure->add_option("MAP", arguments->map, map_help)->required();
  measure->add_option("--source", arguments->source, "The source that the map was made of")
      ->required()
      ->type_name("MESH");
  measure->add_option("--target", arguments->target, "The target that the map was made of")
      ->required()
      ->type_name("MESH");
  measure
      ->add_option("--product", arguments->products,
                   "Meshes or point sets around the source: " + read_product_endings())
      ->type_name("MESH");
  add_part_options(*measure, arguments->parts);
  add_clearance_options(*measure, arguments->clearance);
  add_unit_option(*measure, arguments->unit);
  add_pose_option(*measure, arguments->pose, "skinned glTF products");
  measure->add_flag("--exact", arguments->exact,
                    "Measure the exact map that --keep-exact stored, not the grids");
  measure->add_flag("--untrusted", arguments->untrusted, untrusted_help);
  begin_group(*measure, output_group);
  measure->add_option("-o,--output", arguments->output, printed_output_help)->type_name("FILE");
  measure->add_flag("--json", arguments->json, json_help);
  add_run_options(*measure, arguments->run);
  measure->footer(
      "Examples:\n"
      "  bespoke measure map.vdb --source woman.obj --target man.obj\n"
      "  bespoke measure map.vdb --source woman.obj --target man.obj --product dress.obj --product "
      "shoes.obj --clearance keep\n"
      "  bespoke measure map.vdb --source woman.obj --target man.obj --json | jq .distortion");
  measure->callback([arguments, handle_plan] {
    const MeasureArguments given = std::exchange(*arguments, {});
    require_valid(given.clearance);
    for (const auto& [option, is_used] : {std::pair("--clearance", given.clearance.is_used()),
                                          std::pair("--rigid", !given.parts.rigid.empty()),
                                          std::pair("--similar", !given.parts.similar.empty())})
      if (is_used && given.products.empty())
        throw CLI::ValidationError(option, "needs --product: products are what it is of");
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
