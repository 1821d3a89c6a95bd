#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/asset/asset_io.h"
#include "bespoke/page/view_scene.h"
#include "bespoke/product/mesh_io.h"
#include "commands.h"
#include "help.h"
#include "map_models.h"
#include "output_files.h"
#include "page_output.h"
#include "penetration_check.h"
#include "run_options.h"

namespace bespoke::command {
namespace {

struct ViewArguments {
  MapModelArguments models;
  std::string output;
  std::size_t max_faces = ViewOptions{}.max_faces;
  RunOptions run;
};

std::vector<JobFile> outputs(const ViewArguments& arguments) { return {{"output", arguments.output}}; }

void run(const ViewArguments& arguments, const RunContext& context) {
  require_pages();
  require_safe_outputs(inputs_of(arguments.models), outputs(arguments));
  const MapModels models = read_map_models(arguments.models);
  const std::string scene =
      view_scene({models.asset, models.source, models.target, models.products, models.findings,
                  std::filesystem::path(arguments.models.map).filename().string(), context.command},
                 {.max_faces = arguments.max_faces}, context.progress);
  OutputFiles files;
  files.write_text(arguments.output, whole_page(scene));
  files.keep();
  warn_of_penetration(context, models);
}

}  // namespace

void add_view_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* view =
      app.add_subcommand("view", "Write a page that shows a map in a browser, to judge it by eye");
  begin_group(*view, input_group);
  add_map_model_options(*view, arguments->models);
  begin_group(*view, output_group);
  view->add_option("-o,--output", arguments->output, page_help)->required()->type_name("PAGE.html");
  view->add_option(
          "--max-triangles", arguments->max_faces,
          "Triangles of all meshes together; larger meshes are decimated for display, and the page says so")
      ->check(CLI::Range(std::size_t{1000}, std::size_t{5000000}))
      ->capture_default_str();
  add_run_options(*view, arguments->run);
  view->footer(
      "Examples:\n"
      "  bespoke view dress.vdb --source woman.obj --target man.obj --product dress.obj -o dress.html\n"
      "  bespoke view map.vdb --source a.obj --target b.obj --confidence a.conf --fit-report fit.json -o "
      "map.html");
  view->callback([arguments, handle_plan] {
    const ViewArguments given = std::exchange(*arguments, {});
    handle_plan({given.run, inputs_of(given.models), outputs(given), {}, [given](const RunContext& c) {
                   run(given, c);
                 }});
  });
}

}  // namespace bespoke::command
