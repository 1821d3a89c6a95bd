#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "bespoke/anchors/anchor_files.h"
#include "bespoke/anchors/size_ratio.h"
#include "bespoke/asset/asset_io.h"
#include "bespoke/cloud/target_model.h"
#include "bespoke/error.h"
#include "bespoke/mesh/require_surface.h"
#include "bespoke/number_format.h"
#include "bespoke/output_stream.h"
#include "bespoke/page/view_scene.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/map_request.h"
#include "bespoke/pipeline/model_units.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/product/posed_product.h"
#include "bespoke/product/product_io.h"
#include "bespoke/product/vertex_groups.h"
#include "bespoke/registration/fit_patches.h"
#include "bespoke/report/fit_text.h"
#include "bespoke/report/report.h"
#include "commands.h"
#include "fit_options.h"
#include "fit_warnings.h"
#include "html_pages.h"
#include "output_files.h"
#include "page_output.h"

namespace bespoke::command {
namespace {

void require_consistent(const FitArguments& arguments) {
  const bool fitted = !arguments.fitted.empty();
  if (const std::optional<InapplicableOption> inapplicable =
          inapplicable_option(arguments, {!arguments.anchors.empty(), fitted, arguments.add_corners}))
    throw CLI::ValidationError("--" + inapplicable->name, inapplicable->reason);
  if (fitted && !arguments.confidence_out.empty())
    throw CLI::ValidationError("--confidence-out", "belongs to the registration, which --fitted skips");
  if (!arguments.fitted_out.empty()) require_mesh_ending("--fitted-out", arguments.fitted_out);
}

std::vector<JobFile> inputs(const FitArguments& arguments) {
  return named_files({{"source", arguments.source},
                      {"target", arguments.target},
                      {"anchors", arguments.anchors},
                      {"fitted", arguments.fitted}});
}

std::vector<JobFile> outputs(const FitArguments& arguments) {
  return named_files({{"output", arguments.output},
                      {"fitted-out", arguments.fitted_out},
                      {"confidence-out", arguments.confidence_out},
                      {"report", arguments.report}});
}

/// One number a line, in the order of the source's vertices.
std::string confidence_lines(const std::vector<double>& confidence) {
  std::string lines;
  char line[32];
  for (const double value : confidence) {
    std::snprintf(line, sizeof line, "%.4f\n", value);
    lines += line;
  }
  return lines;
}

void require_model(const TriangleMesh& mesh, const std::string& role, const std::string& path, bool verbose) {
  require_surface(mesh, role + " " + path);
  if (verbose) std::printf("%-12s %s\n", role.c_str(), to_string(inspect_mesh(mesh)).c_str());
}

/// Degenerate faces are told once, here: whatever reads the model later leaves the same ones out.
void warn_of_left_out(const DegenerateFaces& faces, const std::string& path, const RunContext& context) {
  if (faces.count > 0) context.warn(path + ": " + left_out_text(faces), Entry::content_left_as_it_is);
}

/// Skins are taken as viewers show them unless they are asked for as stored, which is said where it matters.
ModelPose pose_of(const std::string& path, const FitArguments& arguments, const RunContext& context) {
  if (!arguments.pose && has_two_poses(path))
    context.warn(
        path +
            ": its skin is stored in another pose than its nodes show, which is taken as it is shown; "
            "`--pose stored` takes the other",
        Entry::content_left_as_it_is);
  return arguments.pose.value_or(ModelPose::shown);
}

TriangleMesh read_model(const std::string& role, const std::string& path, const FitArguments& arguments,
                        const RunContext& context) {
  SourceModel model = read_source_model(path, pose_of(path, arguments, context));
  require_model(model.mesh, role, path, arguments.verbose);
  warn_of_left_out(model.left_out, path, context);
  return std::move(model.mesh);
}

void print_units(const UnitPlan& units, const FitArguments& arguments) {
  for (const auto& [model, scale] :
       {std::pair(arguments.source, units.source_scale), std::pair(arguments.target, units.target_scale)})
    if (scale != 1)
      std::printf("%-12s %s is in %s, converted to %s: times %s\n", "unit", model.c_str(),
                  unit_of_format(model).c_str(), units.unit.c_str(), format_number(scale, 6).c_str());
}

void print_stages(const MadeMap& made, const Anchors& anchors) {
  const Certificate certificate = whole_certificate(made.asset);
  const auto print_certificate = [&] {
    std::printf("%-12s %s\n", "certificate", to_string(certificate).c_str());
  };
  // What matters most comes first.
  if (!certificate.is_bijection()) print_certificate();
  for (const StageLine& stage : stage_lines(made.fit->summary, anchors))
    std::printf("%-12s %s\n", stage.name.c_str(), stage.line.c_str());
  if (certificate.is_bijection()) print_certificate();
  if (!anchors.pairs.empty())
    std::printf("%-12s %s\n", "anchors", to_string(made.fit->summary.elastic.anchor_residuals).c_str());
  std::printf("%-12s %s\n", "vertices", to_string(made.fit->summary.elastic.vertex_residuals).c_str());
}

/// What is wrong with patches shows only on the models; here the file can be named.
void require_usable_patches(const FitArguments& arguments, const Anchors& anchors, const TriangleMesh& source,
                            const TriangleMesh& target) {
  try {
    fit_patches(anchors, source, target);
  } catch (const InvalidInput& error) {
    throw InvalidInput(arguments.anchors + ": " + error.what());
  }
}

std::vector<JobFigure> figures(const MadeMap& made) {
  const FitSummary& summary = made.fit->summary;
  return {{"vertex_residual_p95", summary.elastic.vertex_residuals.p95},
          {"vertex_residual_max", summary.elastic.vertex_residuals.max},
          {"anchor_residual_max", summary.elastic.anchor_residuals.max},
          {"unmet_vertices", summary.elastic.unmet.size()},
          {"bake_error_max", summary.bake->error.max},
          {"tolerance_met", summary.bake->tolerance_met},
          {"bijection", whole_certificate(made.asset).is_bijection()},
          {"steps", made.asset.steps.size()},
          {"voxels", voxel_count(made.asset)}};
}

std::optional<HtmlPages> html_pages(const FitArguments& arguments) {
  if (arguments.html.empty()) return std::nullopt;
  ShownMap shown;
  shown.name = std::filesystem::path(arguments.output).stem().string();
  shown.map = arguments.output;
  shown.source = arguments.source;
  shown.target = arguments.target;
  return HtmlPages(arguments.html, {shown});
}

/// The map's page, which shows what the fit found as well, its picture, and the index.
void write_pages(const HtmlPages& pages, const FitArguments& arguments, const Problem& input,
                 const MadeMap& made, const RunContext& context) {
  const std::string title = std::filesystem::path(arguments.output).filename().string();
  const std::string scene =
      view_scene({made.asset, input.source, input.target, {}, findings_of(*made.fit), title, context.command},
                 {}, context.progress);
  pages.write(scene, *context.maps.open(arguments.output, MapForm::grids, {}));
}

/// Of a regular file, bytes.
std::optional<std::uintmax_t> size_of_file(const std::string& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  return error ? std::nullopt : std::optional(bytes);
}

/// Lists what is wrong with a map that is not proved, and shows any other.
std::string next_command(const FitArguments& arguments, const MadeMap& made) {
  if (!whole_certificate(made.asset).is_bijection()) return command_text({"check", arguments.output});
  const std::string page = std::filesystem::path(arguments.output).replace_extension(".html").string();
  return command_text({has_pages() ? "view" : "report", arguments.output, "--source", arguments.source,
                       "--target", arguments.target, "-o", page});
}

void run(const FitArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs(arguments), outputs(arguments));
  require_map_ending(arguments.output);
  if (!arguments.html.empty() && is_stream(arguments.output))
    throw CLI::ValidationError("--html", "shows the map from its file; give -o the name of a file");
  const std::optional<HtmlPages> pages = html_pages(arguments);
  const auto start = std::chrono::steady_clock::now();
  TriangleMesh source = read_model("source", arguments.source, arguments, context);
  TargetModel target_model = read_target(arguments.target, pose_of(arguments.target, arguments, context));
  const TriangleMesh& target = target_model.mesh;
  require_model(target, "target", arguments.target, arguments.verbose);
  warn_of_left_out(target_model.left_out, arguments.target, context);
  Anchors anchors;
  if (!arguments.anchors.empty()) anchors = read_anchor_file(arguments.anchors, {&source, &target});
  const UnitPlan units =
      bring_to_one_unit({arguments.unit, unit_of_format(arguments.source), unit_of_format(arguments.target),
                         arguments.source, arguments.target},
                        anchors);
  source.vertices *= units.source_scale;
  target_model.mesh.vertices *= units.target_scale;
  if (!arguments.run.quiet) print_units(units, arguments);
  std::optional<TriangleMesh> fitted;
  if (!arguments.fitted.empty()) {
    fitted = read_model("fitted", arguments.fitted, arguments, context);
    fitted->vertices *= scale_to_unit(arguments.fitted, units.unit);
    require_same_connectivity(source, *fitted, arguments.fitted);
  }
  if (!arguments.anchors.empty() && anchors.pairs.empty() && anchors.curves.empty() &&
      arguments.fitted.empty())
    throw InvalidInput(
        arguments.anchors +
        ": the fit needs 3 anchor pairs that are not collinear; there are 0; without --anchors "
        "models in similar pose are aligned by their surfaces");
  require_usable_patches(arguments, anchors, source, target);
  warn_of_input(context, source, target, anchors);
  const double size = diagonal(source.vertices),
               size_scale = power_of_two_scale(size_ratio(anchors, source, target));
  estimate_anchor_sigmas(anchors, arguments, size, size_scale);
  if (arguments.add_corners) add_box_corners(anchors, source.vertices, target.vertices);

  const Problem input{
      source,
      target,
      anchors,
      fitted ? &*fitted : nullptr,
      target_model.cloud ? &*target_model.cloud : nullptr,
      [&] { return vertex_groups(arguments.source, arguments.pose.value_or(ModelPose::shown)); }};
  const MakeMapOptions options = make_options(arguments, size, size_scale);
  const MadeMap made = make_map(input, options, context.progress);
  if (arguments.require_certified && !whole_certificate(made.asset).is_bijection())
    throw SolverError("the map is not certified as a bijection: " + to_string(whole_certificate(made.asset)));
  context.progress.check();

  OutputFiles files;
  files.write(arguments.output, [&](const auto& path) { write_asset(path, made.asset); });
  if (!arguments.fitted_out.empty())
    files.write(arguments.fitted_out, [&](const auto& path) {
      write_triangle_mesh(path, {made.fit->target_from_source * made.fit->fitted_vertices, source.faces},
                          units.unit);
    });
  if (!arguments.confidence_out.empty())
    files.write_text(arguments.confidence_out, confidence_lines(made.fit->confidence));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!arguments.report.empty()) files.write_text(arguments.report, fit_report(input, made, seconds));
  files.keep();
  if (pages) write_pages(*pages, arguments, input, made, context);

  context.findings.figures = figures(made);
  warn_of_misses(context, input, options, made);
  if (arguments.verbose) print_stages(made, anchors);
  if (arguments.verbose) std::printf("%-12s %s, %.1f s\n", "written", arguments.output.c_str(), seconds);
  if (!arguments.run.quiet && !arguments.verbose)
    std::fputs(fit_text({input, made, arguments.source, arguments.target, arguments.output, arguments.fitted,
                         size_of_file(arguments.output), seconds, next_command(arguments, made),
                         arguments.tolerance.has_value()})
                   .c_str(),
               stdout);
}

}  // namespace

void add_fit_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = app.add_subcommand("fit", "Register two reference models and store the map between them");
  add_fit_options(*fit, *arguments);
  fit->footer(
      "Examples:\n"
      "  bespoke fit woman.obj man.obj --anchors pairs.json -o map.vdb\n"
      "  bespoke fit woman.obj man.obj -o map.vdb\n"
      "  bespoke fit woman.obj man.obj --anchors pairs.csv -o map.vdb --lambda 5%\n"
      "  bespoke fit woman.obj man.obj --fitted woman_on_man.obj -o map.vdb");
  fit->callback([arguments, handle_plan] {
    const FitArguments given = std::exchange(*arguments, {});
    require_consistent(given);
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
