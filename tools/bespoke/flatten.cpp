#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/pattern/write_pattern.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/unknown_ending.h"
#include "commands.h"
#include "help.h"
#include "name_option.h"
#include "output_files.h"
#include "pattern_options.h"

namespace bespoke::command {
namespace {

struct FlattenArguments {
  std::string product;
  std::string output;
  std::string source;
  std::string seams;
  std::string anchors;
  std::string stretch_limit;
  std::vector<std::string> eases;
  std::optional<PieceRule> pieces;
  std::optional<FlatteningMethod> method;
  std::optional<AllowanceCorners> corners;
  std::optional<PaperSize> paper;
  GarmentOptions garment;
  PatternOptions pattern;
  SheetOptions sheet;
  PatternFileOptions file;
  RunOptions run;
};

/// "3,10": percent along the grain and across it.
StretchLimits stretch_limits(const std::string& text) {
  double warp = 0, weft = 0;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf%c", &warp, &weft, &rest) != 2 || !(warp >= 0 && weft >= 0))
    throw CLI::ValidationError("--stretch-limit",
                               "\"" + text + "\" must be two percentages, warp,weft: 3,10");
  constexpr double per_percent = 0.01;
  return {per_percent * warp, per_percent * weft};
}

std::vector<JobFile> flatten_inputs(const FlattenArguments& arguments) {
  return named_files({{"product", arguments.product},
                      {"source", arguments.source},
                      {"seams", arguments.seams},
                      {"anchors", arguments.anchors}});
}

std::vector<JobFile> flatten_outputs(const FlattenArguments& arguments) {
  return {{"output", arguments.output}};
}

std::vector<JobFigure> figures(const FlatPattern& pattern) {
  double strain = 0, gap = 0;
  for (const PatternPiece& piece : pattern.pieces) strain = std::max(strain, piece.strain.strain_p95);
  for (const PatternSeam& seam : pattern.seams)
    gap = std::max(gap, std::abs(seam.lengths[0] - seam.lengths[1] - seam.seam.ease));
  return {{"pieces", pattern.pieces.size()}, {"strain_p95", strain}, {"seam_difference_mm", gap}};
}

PatternOptions pattern_options(const FlattenArguments& arguments, const Garment& garment) {
  PatternOptions options = arguments.pattern;
  options.flatten.method = arguments.method.value_or(options.flatten.method);
  set_eases(arguments.eases, options);
  if (!arguments.anchors.empty()) {
    const std::string& unit = arguments.garment.unit;
    options.marks =
        marks_of_anchors(arguments.anchors, unit.empty() ? unit_of_format(arguments.product) : unit);
  }
  if (!arguments.stretch_limit.empty()) options.stretch_limits = stretch_limits(arguments.stretch_limit);
  if (!arguments.seams.empty()) options.cut.seams = read_seam_file(arguments.seams, garment.mesh);
  return options;
}

void run(const FlattenArguments& arguments, const RunContext& context) {
  GarmentOptions reading = arguments.garment;
  reading.rule = arguments.pieces.value_or(reading.rule);
  const Garment garment = read_garment(arguments.product, reading);
  std::optional<Garment> source;
  if (!arguments.source.empty()) source = read_garment(arguments.source, reading);
  const PatternOptions options = pattern_options(arguments, garment);
  context.progress.check();
  const FlatPattern pattern = flat_pattern(garment, source ? &*source : nullptr, options);
  SheetOptions sheet_options = arguments.sheet;
  sheet_options.corners = arguments.corners.value_or(sheet_options.corners);
  const Sheet sheet = pattern_sheet(pattern, sheet_options);
  PatternFileOptions file = arguments.file;
  file.paper = arguments.paper.value_or(file.paper);
  file.name = std::filesystem::path(arguments.product).stem().string();
  OutputFiles files;
  files.write(arguments.output,
              [&](const std::filesystem::path& path) { write_pattern(path, pattern, sheet, file); });
  files.keep();
  context.findings.figures = figures(pattern);
  if (arguments.run.quiet) return;
  context.print(to_string(pattern, options) + "sheet        " + format_number(sheet.width / 10, 4) + " x " +
                format_number(sheet.height / 10, 4) + " cm\n" + "written      " + arguments.output + "\n");
}

void add_input(CLI::App& flatten, FlattenArguments& arguments) {
  begin_group(flatten, input_group);
  flatten.add_option("PRODUCT", arguments.product, "Garment to cut into pieces and flatten")->required();
  flatten
      .add_option(
          "--source", arguments.source,
          "The product before the map carried it: its pieces give the grain, and their strain stands beside")
      ->type_name("MESH");
  flatten
      .add_option("--unit", arguments.garment.unit, "Unit of the coordinates, where the format says none: cm")
      ->type_name("UNIT");
  add_name_option(
      flatten, "--pieces", arguments.pieces, piece_rules,
      "What ends a piece: texture charts, OBJ groups, objects, materials (of glTF nodes, primitives), or "
      "what shares no vertex (default: auto, the first that the file has)");
  flatten
      .add_option("--seams", arguments.seams,
                  "Cut along edges, paths and lines between vertices instead, by numbers from 1, as `pick "
                  "--seams` writes them; pieces get names")
      ->type_name("SEAMS.json");
  flatten
      .add_option("--anchors", arguments.anchors,
                  "Notches where seams pass the anchors of the source, and the ends of its curves")
      ->type_name("ANCHORS");
  flatten.add_flag("--auto-cut", arguments.pattern.cut.auto_cut,
                   "Cut a piece that is no disk along shortest loops, instead of refusing it");
}

void add_method(CLI::App& flatten, FlattenArguments& arguments) {
  begin_group(flatten, method_group);
  add_name_option(flatten, "--method", arguments.method, flattening_methods,
                  "Keep lengths as well as can be, angles, or areas (default: rigid)");
  flatten
      .add_option("--ease", arguments.eases,
                  "Millimetres that the sides of a seam may differ by; more is named (default: 1). Or of one "
                  "seam, by its number, what the first side that is printed is longer by (repeatable)")
      ->allow_extra_args(false)
      ->type_name("MM|SEAM=MM");
  flatten
      .add_option(
          "--darts", arguments.pattern.max_darts,
          "Cut at most so many darts where pieces overlap themselves or strain by more than 2 % (default: 0, "
          "suggest them)")
      ->check(CLI::Range(0, 100))
      ->type_name("N");
  flatten
      .add_option(
          "--stretch-limit", arguments.stretch_limit,
          "Percent that cloth stretches along and across the grain; where it would have to stretch more is "
          "reported")
      ->type_name("WARP,WEFT");
}

void add_output(CLI::App& flatten, FlattenArguments& arguments) {
  begin_group(flatten, output_group);
  flatten.add_option("-o,--output", arguments.output, "Pattern to write: " + pattern_endings())
      ->required()
      ->type_name("FILE");
  add_seam_allowance(flatten, arguments.sheet.seam_allowance);
  add_name_option(flatten, "--corners", arguments.corners, allowance_corners,
                  "Corners of the seam allowance (default: mitred)");
  add_millimetres(flatten, "--width", arguments.sheet.width, CLI::Range(200.0, 20000.0),
                  "Of cloth or roll, millimetres (default: 1500)");
  flatten.add_option("--size", arguments.sheet.size, "Size that the labels name")->type_name("NAME");
  flatten
      .add_option("--quantity", arguments.sheet.quantity,
                  "How often each piece is cut, for the labels (default: 1)")
      ->check(CLI::Range(1, 1000))
      ->type_name("N");
  add_name_option(flatten, "--paper", arguments.paper, paper_sizes,
                  "Pages of PDF: tiles, or one roll (default: a4)");
  flatten.add_flag("--strain-colours", arguments.file.with_strain_colours,
                   "Colour faces in SVG and PDF by their strain: white 0, red 5 % and more");
  add_run_options(flatten, arguments.run);
}

}  // namespace

void add_flatten_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<FlattenArguments>();
  CLI::App* flatten = app.add_subcommand(
      "flatten", "Cut a garment into pieces, flatten them, and write the pattern in true scale");
  add_input(*flatten, *arguments);
  add_method(*flatten, *arguments);
  add_output(*flatten, *arguments);
  flatten->footer(
      "A seam file cuts along edges, shortest paths, or lines through vertices and shares of edges, and "
      "names "
      "pieces by a vertex; what ends inside is a dart. The side of the piece \"longer\" eases in:\n"
      "  {\"seams\":[{\"path\":[12,80,301],\"ease\":15,\"longer\":\"sleeve\"},\n"
      "            {\"edges\":[[4,5],[5,9]]},{\"line\":[9,[12,80,0.4],77]}],\n"
      "   \"pieces\":[{\"name\":\"front\",\"vertex\":77}],\"widths\":[{\"name\":\"hip\",\"vertex\":9}]}\n\n"
      "Examples:\n"
      "  bespoke flatten skirt.obj --unit cm --auto-cut -o skirt.svg\n"
      "  bespoke flatten carried.obj --source dress.obj --unit cm --seams seams.json --seam-allowance 10 -o "
      "dress.pdf\n"
      "  bespoke flatten dress.glb --pieces materials --width 1400 -o dress.dxf");
  flatten->callback([arguments, handle_plan] {
    const FlattenArguments given = std::exchange(*arguments, {});
    if (!can_write_pattern(given.output))
      throw UnknownEnding(given.output + ": its name must end in " + pattern_endings());
    if (!given.stretch_limit.empty()) stretch_limits(given.stretch_limit);
    PatternOptions checked;
    set_eases(given.eases, checked);
    require_safe_outputs(flatten_inputs(given), flatten_outputs(given));
    handle_plan(
        {given.run, flatten_inputs(given), flatten_outputs(given), {}, [given](const RunContext& context) {
           run(given, context);
         }});
  });
}

}  // namespace bespoke::command
