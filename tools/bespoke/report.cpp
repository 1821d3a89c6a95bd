#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include "bespoke/page/map_report.h"
#include "bespoke/unknown_ending.h"
#include "commands.h"
#include "help.h"
#include "map_models.h"
#include "output_files.h"
#include "penetration_check.h"
#include "run_options.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  MapModelArguments models;
  std::string output;
  RunOptions run;
};

std::vector<JobFile> outputs(const ReportArguments& arguments) { return {{"output", arguments.output}}; }

bool is_html(const ReportArguments& arguments) { return fs::path(arguments.output).extension() == ".html"; }

void require_ending(const ReportArguments& arguments) {
  if (!is_html(arguments) && fs::path(arguments.output).extension() != ".md")
    throw UnknownEnding("--output: " + arguments.output + " must end in .md or .html");
}

void run(const ReportArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs_of(arguments.models), outputs(arguments));
  const fs::path output = arguments.output;
  const MapModels models = read_map_models(arguments.models);
  const MapReport report =
      map_report({models.asset, models.source, models.target, models.products, models.findings,
                  fs::path(arguments.models.map).filename().string(), context.command},
                 context.progress);
  OutputFiles files;
  if (is_html(arguments)) {
    files.write_text(output, report_html(report));
  } else {
    const std::string prefix = output.stem().string() + "_";
    for (const ReportPicture& picture : report.pictures) {
      const fs::path path = output.parent_path() / (prefix + picture.name + ".png");
      files.write_text(path, picture.png);
      context.findings.further_outputs.push_back(path);
    }
    files.write_text(output, report_markdown(report, prefix));
  }
  files.keep();
  warn_of_penetration(context, models);
}

}  // namespace

void add_report_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* report =
      app.add_subcommand("report", "Write pictures and measures of a map, to mail or to attach");
  begin_group(*report, input_group);
  add_map_model_options(*report, arguments->models);
  begin_group(*report, output_group);
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
  report->callback([arguments, handle_plan] {
    const ReportArguments given = std::exchange(*arguments, {});
    require_ending(given);
    handle_plan({given.run, inputs_of(given.models), outputs(given), {}, [given](const RunContext& c) {
                   run(given, c);
                 }});
  });
}

}  // namespace bespoke::command
