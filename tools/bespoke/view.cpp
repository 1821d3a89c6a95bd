#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/asset/asset_io.h"
#include "bespoke/page/view_scene.h"
#include "bespoke/pipeline/open_map.h"
#include "bespoke/product/mesh_io.h"
#include "clearance_option.h"
#include "commands.h"
#include "corrected_products.h"
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
  std::vector<std::string> patterns;
  ClearanceOption clearance;
  std::string output;
  std::size_t max_faces = ViewOptions{}.max_faces;
  RunOptions run;
};

std::vector<JobFile> inputs(const ViewArguments& arguments) {
  std::vector<JobFile> files = inputs_of(arguments.models);
  for (const std::string& pattern : arguments.patterns) files.push_back({"pattern", pattern});
  return files;
}

std::vector<JobFile> outputs(const ViewArguments& arguments) { return {{"output", arguments.output}}; }

/// Opens the map again, as a carrier, where products are to be kept clear.
CorrectedProducts where_kept_clear(const ViewArguments& arguments, const MapModels& models) {
  const MapModelArguments& given = arguments.models;
  if (!arguments.clearance.is_used()) return {};
  return corrected_products({given.products, given.unit, given.pose, arguments.clearance}, models.products,
                            open_map(given.map, MapForm::grids, {.untrusted = given.untrusted}));
}

std::vector<std::string> notes_of(const CorrectedProducts& corrected) {
  std::vector<std::string> notes;
  if (corrected.order) notes.push_back(to_string(*corrected.order));
  for (const ProductClearance& product : corrected.found) {
    notes.push_back(product.product + ": " + to_string(product.summary));
    for (const LayerContact& contact : product.layers) notes.push_back(to_string(contact));
  }
  return notes;
}

void run(const ViewArguments& arguments, const RunContext& context) {
  require_pages();
  require_safe_outputs(inputs(arguments), outputs(arguments));
  std::vector<ProductPattern> patterns;
  for (const std::string& path : arguments.patterns)
    patterns.push_back({patterns.size(), read_pattern(path)});
  const MapModels models = read_map_models(arguments.models);
  const CorrectedProducts corrected = where_kept_clear(arguments, models);
  const std::string scene =
      view_scene({models.asset, models.source, models.target, models.products, models.findings,
                  std::filesystem::path(arguments.models.map).filename().string(), context.command,
                  std::move(patterns), corrected.places, notes_of(corrected)},
                 {.max_faces = arguments.max_faces}, context.progress);
  OutputFiles files;
  files.write_text(arguments.output, whole_page(scene));
  files.keep();
  if (corrected.order) {
    if (!arguments.run.quiet) std::printf("%s\n", to_string(*corrected.order).c_str());
    warn_of_layers(context, *corrected.order);
  }
  if (!arguments.run.quiet)
    for (const ProductClearance& found : corrected.found) print_clearance(found.product, found);
  warn_of_penetration(context, models, corrected.places);
}

}  // namespace

void add_view_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<ViewArguments>();
  CLI::App* view =
      app.add_subcommand("view", "Write a page that shows a map in a browser, to judge it by eye");
  begin_group(*view, input_group);
  add_map_model_options(*view, arguments->models);
  view->add_option(
          "--pattern", arguments->patterns,
          "Flat pieces of the products, in their order, as `flatten -o pieces.json` writes them: shown "
          "beside, with the place of the pointer on both")
      ->type_name("PIECES.json");
  add_clearance_options(*view, arguments->clearance);
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
      "  bespoke view dress.vdb --source woman.obj --target man.obj --product dress.obj --pattern "
      "pieces.json -o "
      "dress.html\n"
      "  bespoke view map.vdb --source woman.obj --target man.obj --product shirt.obj --product jacket.obj "
      "--clearance keep -o outfit.html\n"
      "  bespoke view map.vdb --source a.obj --target b.obj --confidence a.conf --fit-report fit.json -o "
      "map.html");
  view->callback([arguments, handle_plan] {
    const ViewArguments given = std::exchange(*arguments, {});
    require_valid(given.clearance);
    if (given.clearance.is_used() && given.models.products.empty())
      throw CLI::ValidationError("--clearance", "needs --product: products are what is kept clear");
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
