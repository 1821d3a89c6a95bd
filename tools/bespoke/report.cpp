#include <filesystem>
#include <memory>
#include <string>

#include "bespoke/page/map_report.h"
#include "commands.h"
#include "map_models.h"
#include "output_files.h"
#include "page_output.h"
#include "run_options.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  MapModelArguments models;
  std::string output;
  RunOptions run;
};

void run(const ReportArguments& arguments, const Progress& progress) {
  const fs::path output = arguments.output;
  const bool is_html = output.extension() == ".html";
  if (!is_html && output.extension() != ".md")
    throw CLI::ValidationError("--output", output.string() + " must end in .md or .html");
  require_safe_outputs(inputs_of(arguments.models), {output});
  const MapModels models = read_map_models(arguments.models);
  const MapReport report =
      map_report({models.asset, models.source, models.target, models.products, models.findings,
                  fs::path(arguments.models.map).filename().string(), typed_command()},
                 progress);
  OutputFiles outputs;
  if (is_html) {
    outputs.write_text(output, report_html(report));
  } else {
    const std::string prefix = output.stem().string() + "_";
    for (const ReportPicture& picture : report.pictures)
      outputs.write_text(output.parent_path() / (prefix + picture.name + ".png"), picture.png);
    outputs.write_text(output, report_markdown(report, prefix));
  }
  outputs.keep();
}

}  // namespace

void add_report_command(CLI::App& app) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* report =
      app.add_subcommand("report", "Write pictures and measures of a map, to mail or to attach");
  add_map_model_options(*report, arguments->models);
  report
      ->add_option("-o,--output", arguments->output,
                   "Report to write: .md with its pictures beside it as PNG files, or .html with them inside")
      ->required()
      ->type_name("REPORT");
  add_run_options(*report, arguments->run);
  report->footer(
      "Pictures are drawn on the processor: no display, browser or Node.js is needed.\n\n"
      "Examples:\n"
      "  bespoke report dress.vdb --source woman.obj --target man.obj --product dress.obj -o dress.md\n"
      "  bespoke report map.vdb --source a.obj --target b.obj -o map.html");
  report->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
