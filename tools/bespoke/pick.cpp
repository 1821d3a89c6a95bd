#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/page/pick_scene.h"
#include "bespoke/page/seam_scene.h"
#include "bespoke/pattern/seam_file.h"
#include "bespoke/pipeline/model_units.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"
#include "bespoke/text_lines.h"
#include "commands.h"
#include "help.h"
#include "output_files.h"
#include "page_output.h"
#include "pose_option.h"

namespace bespoke::command {
namespace {

struct PickArguments {
  std::string source;
  std::string target;
  std::string anchors;
  std::string seams;  ///< a file to begin with, or empty
  bool is_for_seams = false;
  std::string output;
  std::optional<ModelPose> pose;
};

std::string name_of_file(const std::string& path) { return std::filesystem::path(path).stem().string(); }

/// Anchors without a unit are in the coordinates of the models' files, and picked so.
void show_in_unit_of_anchors(PickModel& source, PickModel& target, Anchors& anchors) {
  const UnitPlan plan = bring_to_one_unit(
      {anchors.unit, unit_of_format(source.path), unit_of_format(target.path), source.path, target.path},
      anchors);
  source.mesh.vertices *= plan.source_scale;
  target.mesh.vertices *= plan.target_scale;
}

void write_page(const std::string& output, const std::string& scene) {
  OutputFiles outputs;
  outputs.write_text(output, whole_page(scene));
  outputs.keep();
}

void pick_seams(const PickArguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.source};
  if (!arguments.seams.empty()) inputs.emplace_back(arguments.seams);
  require_safe_outputs(inputs, {arguments.output});
  const Product product = read_product(arguments.source);
  const TriangleMesh garment{product.vertices, triangulated(product)};
  if (garment.faces.cols() == 0)
    throw InvalidInput(arguments.source + ": it has no faces, so there is nothing to cut");
  std::string seams;
  if (!arguments.seams.empty()) {
    seams = read_text_file(arguments.seams);
    parse_seams(seams, arguments.seams, garment);  // says what is wrong in it
  }
  write_page(arguments.output, seam_scene({arguments.source, garment, product.unit, seams,
                                           "Seams of " + name_of_file(arguments.source), typed_command()}));
}

void pick_anchors(const PickArguments& arguments) {
  std::vector<std::filesystem::path> inputs{arguments.source, arguments.target};
  if (!arguments.anchors.empty()) inputs.push_back(arguments.anchors);
  require_safe_outputs(inputs, {arguments.output});
  const ModelPose pose = arguments.pose.value_or(ModelPose::shown);
  PickModel source{arguments.source, read_source_model(arguments.source, pose).mesh};
  PickModel target{arguments.target, read_target(arguments.target, pose).mesh};
  std::optional<Anchors> anchors;
  if (!arguments.anchors.empty()) anchors = read_anchor_file(arguments.anchors, {&source.mesh, &target.mesh});
  if (anchors && !anchors->unit.empty()) show_in_unit_of_anchors(source, target, *anchors);
  const std::string title =
      "Anchors of " + name_of_file(arguments.source) + " and " + name_of_file(arguments.target);
  write_page(arguments.output, pick_scene({source, target, anchors, title, typed_command()}));
}

void run(const PickArguments& arguments) {
  if (arguments.is_for_seams && !arguments.target.empty())
    throw CLI::ValidationError("--seams",
                               "are picked on one garment, but " + arguments.target + " is a second");
  if (arguments.is_for_seams && arguments.pose)
    throw CLI::ValidationError("--seams", "excludes --pose: `flatten` cuts garments as a viewer shows them");
  if (arguments.is_for_seams && !arguments.anchors.empty())
    throw CLI::ValidationError("--seams", "excludes --anchors");
  if (!arguments.is_for_seams && arguments.target.empty())
    throw CLI::ValidationError("B", "is required: anchors are picked on two models, seams (--seams) on one");
  require_pages();
  if (arguments.is_for_seams)
    pick_seams(arguments);
  else
    pick_anchors(arguments);
}

}  // namespace

void add_pick_command(CLI::App& app) {
  auto arguments = std::make_shared<PickArguments>();
  CLI::App* pick = app.add_subcommand(
      "pick",
      "Write a page on which to pick anchors: click on one model, then on the other; or seams on a garment");
  begin_group(*pick, input_group);
  pick->add_option("A", arguments->source, "Source model; with --seams the garment")
      ->required()
      ->type_name("MESH");
  pick->add_option("B", arguments->target, "Target model; none with --seams")->type_name("MESH");
  pick->add_option("--anchors", arguments->anchors,
                   "Anchors and curves to begin with, JSON or CSV; patches are kept")
      ->type_name("FILE");
  CLI::Option* const seams =
      pick->add_option(
              "--seams", arguments->seams,
              "Pick where a garment is cut, for `flatten --seams`; with a file, begin with its seams")
          ->expected(0, 1)
          ->type_name("[SEAMS.json]");
  add_pose_option(*pick, arguments->pose, "skinned glTF models");
  begin_group(*pick, output_group);
  pick->add_option("-o,--output", arguments->output, page_help)->required()->type_name("PAGE.html");
  pick->footer(
      "Examples:\n"
      "  bespoke pick woman.obj man.obj -o pick.html\n"
      "  bespoke pick woman.obj man.obj --anchors first.json -o pick.html\n"
      "  bespoke pick skirt.obj --seams -o seams.html");
  pick->callback([arguments, seams] {
    arguments->is_for_seams = seams->count() > 0;
    run(*arguments);
  });
}

}  // namespace bespoke::command
