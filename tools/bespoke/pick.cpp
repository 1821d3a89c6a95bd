#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/page/pick_scene.h"
#include "bespoke/pipeline/model_units.h"
#include "bespoke/product/format_unit.h"
#include "commands.h"
#include "help.h"
#include "output_files.h"
#include "page_output.h"

namespace bespoke::command {
namespace {

struct PickArguments {
  std::string source;
  std::string target;
  std::string anchors;
  std::string output;
};

/// Anchors without a unit are in the coordinates of the models' files, and picked so.
void show_in_unit_of_anchors(PickModel& source, PickModel& target, Anchors& anchors) {
  const UnitPlan plan = bring_to_one_unit(
      {anchors.unit, unit_of_format(source.path), unit_of_format(target.path), source.path, target.path},
      anchors);
  source.mesh.vertices *= plan.source_scale;
  target.mesh.vertices *= plan.target_scale;
}

void run(const PickArguments& arguments) {
  require_pages();
  std::vector<std::filesystem::path> inputs{arguments.source, arguments.target};
  if (!arguments.anchors.empty()) inputs.push_back(arguments.anchors);
  require_safe_outputs(inputs, {arguments.output});
  PickModel source{arguments.source, read_source(arguments.source)};
  PickModel target{arguments.target, read_target(arguments.target).mesh};
  std::optional<Anchors> anchors;
  if (!arguments.anchors.empty()) anchors = read_anchor_file(arguments.anchors, {&source.mesh, &target.mesh});
  if (anchors && !anchors->unit.empty()) show_in_unit_of_anchors(source, target, *anchors);
  const auto name = [](const std::string& path) { return std::filesystem::path(path).stem().string(); };
  const std::string title = "Anchors of " + name(arguments.source) + " and " + name(arguments.target);
  OutputFiles outputs;
  outputs.write_text(arguments.output,
                     whole_page(pick_scene({source, target, anchors, title, typed_command()})));
  outputs.keep();
}

}  // namespace

void add_pick_command(CLI::App& app) {
  auto arguments = std::make_shared<PickArguments>();
  CLI::App* pick = app.add_subcommand(
      "pick", "Write a page on which to pick anchors: click on one model, then on the other");
  begin_group(*pick, input_group);
  pick->add_option("A", arguments->source, "Source model")->required()->type_name("MESH");
  pick->add_option("B", arguments->target, "Target model")->required()->type_name("MESH");
  pick->add_option("--anchors", arguments->anchors,
                   "Anchors and curves to begin with, JSON or CSV; patches are kept")
      ->type_name("FILE");
  begin_group(*pick, output_group);
  pick->add_option("-o,--output", arguments->output, page_help)->required()->type_name("PAGE.html");
  pick->footer(
      "Examples:\n"
      "  bespoke pick woman.obj man.obj -o pick.html\n"
      "  bespoke pick woman.obj man.obj --anchors first.json -o pick.html");
  pick->callback([arguments] { run(*arguments); });
}

}  // namespace bespoke::command
