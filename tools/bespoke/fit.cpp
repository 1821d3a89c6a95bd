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
#include "bespoke/output_stream.h"
#include "bespoke/page/view_scene.h"
#include "bespoke/pipeline/fit_mapping.h"
#include "bespoke/pipeline/fit_patches.h"
#include "bespoke/pipeline/map_request.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/mesh_io.h"
#include "bespoke/product/product_io.h"
#include "bespoke/product/vertex_groups.h"
#include "bespoke/report/report.h"
#include "commands.h"
#include "fit_warnings.h"
#include "html_pages.h"
#include "length_option.h"
#include "memory_option.h"
#include "name_option.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

struct FitArguments : MapRequest {
  std::string source;
  std::string target;
  std::string anchors;
  std::string output;
  std::string fitted;
  std::string fitted_out;
  std::string confidence_out;
  std::string report;
  std::string html;
  bool require_certified = false;
  bool add_corners = false;
  RunOptions run;
};

void require_consistent(const FitArguments& arguments) {
  const bool fitted = !arguments.fitted.empty();
  if (const std::optional<InapplicableOption> inapplicable =
          inapplicable_option(arguments, {!arguments.anchors.empty(), fitted, arguments.add_corners}))
    throw CLI::ValidationError("--" + inapplicable->name, inapplicable->reason);
  if (fitted && !arguments.confidence_out.empty())
    throw CLI::ValidationError("--confidence-out", "belongs to the surface fitting, which --fitted skips");
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

void require_model(const TriangleMesh& mesh, const std::string& role, const std::string& path, bool quiet) {
  require_surface(mesh, role + " " + path);
  if (!quiet) std::printf("%-12s %s\n", role.c_str(), to_string(inspect_mesh(mesh)).c_str());
}

TriangleMesh read_model(const std::string& role, const std::string& path, bool quiet) {
  TriangleMesh mesh = read_source(path);
  require_model(mesh, role, path, quiet);
  return mesh;
}

void print_stages(const MadeMap& made, const Anchors& anchors) {
  const Certificate certificate = whole_certificate(made.asset);
  const auto print_certificate = [&] {
    std::printf("%-12s %s\n", "certificate", to_string(certificate).c_str());
  };
  // What matters most comes first.
  if (!certificate.is_bijection()) print_certificate();
  for (const StageLine& stage : stage_lines(made.fit.summary, anchors))
    std::printf("%-12s %s\n", stage.name.c_str(), stage.line.c_str());
  if (certificate.is_bijection()) print_certificate();
  if (!anchors.pairs.empty())
    std::printf("%-12s %s\n", "anchors", to_string(made.fit.summary.elastic.anchor_residuals).c_str());
  std::printf("%-12s %s\n", "vertices", to_string(made.fit.summary.elastic.vertex_residuals).c_str());
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
  const FitSummary& summary = made.fit.summary;
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
void write_pages(const HtmlPages& pages, const FitArguments& arguments, const MakeMapInput& input,
                 const MadeMap& made, const RunContext& context) {
  const std::string title = std::filesystem::path(arguments.output).filename().string();
  const std::string scene =
      view_scene({made.asset, input.source, input.target, {}, findings_of(made.fit), title, context.command},
                 {}, context.progress);
  pages.write(scene, *context.maps.open(arguments.output, MapForm::grids, {}));
}

void run(const FitArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs(arguments), outputs(arguments));
  require_map_ending(arguments.output);
  if (!arguments.html.empty() && is_stream(arguments.output))
    throw CLI::ValidationError("--html", "shows the map from its file; give -o the name of a file");
  const std::optional<HtmlPages> pages = html_pages(arguments);
  const auto start = std::chrono::steady_clock::now();
  const bool quiet = arguments.run.quiet;
  const TriangleMesh source = read_model("source", arguments.source, quiet);
  const TargetModel target_model = read_target(arguments.target);
  const TriangleMesh& target = target_model.mesh;
  require_model(target, "target", arguments.target, quiet);
  std::optional<TriangleMesh> fitted;
  if (!arguments.fitted.empty()) {
    fitted = read_model("fitted", arguments.fitted, quiet);
    require_same_connectivity(source, *fitted, arguments.fitted);
  }
  Anchors anchors;
  if (!arguments.anchors.empty()) anchors = read_anchor_file(arguments.anchors, {&source, &target});
  for (const std::string& model : {arguments.source, arguments.target}) {
    require_unit_of_format(model, anchors.unit);
    if (anchors.unit.empty()) anchors.unit = unit_of_format(model);
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

  const MakeMapInput input{source,
                           target,
                           anchors,
                           fitted ? &*fitted : nullptr,
                           target_model.cloud ? &*target_model.cloud : nullptr,
                           [&] { return vertex_groups(arguments.source, source.vertices); }};
  const MakeMapOptions options = make_options(arguments, size, size_scale);
  const MadeMap made = make_map(input, options, context.progress);
  if (arguments.require_certified && !whole_certificate(made.asset).is_bijection())
    throw SolverError("the map is not certified as a bijection: " + to_string(whole_certificate(made.asset)));
  context.progress.check();

  OutputFiles files;
  files.write(arguments.output, [&](const auto& path) { write_asset(path, made.asset); });
  if (!arguments.fitted_out.empty())
    files.write(arguments.fitted_out, [&](const auto& path) {
      write_triangle_mesh(path, {made.fit.target_from_source * made.fit.fitted_vertices, source.faces});
    });
  if (!arguments.confidence_out.empty())
    files.write_text(arguments.confidence_out, confidence_lines(made.fit.confidence));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!arguments.report.empty()) files.write_text(arguments.report, fit_report(input, made, seconds));
  files.keep();
  if (pages) write_pages(*pages, arguments, input, made, context);

  context.findings.figures = figures(made);
  warn_of_misses(context, input, options, made);
  if (quiet) return;
  print_stages(made, anchors);
  std::printf("%-12s %s, %.1f s\n", "written", arguments.output.c_str(), seconds);
}

void add_method_options(CLI::App& fit, FitArguments& arguments) {
  const MakeMapOptions defaults = default_options(1);
  const auto with_default = [](const std::string& text, std::string_view value) {
    return text + " (default: " + std::string(value) + ")";
  };
  add_name_option(fit, "--surface-fit", arguments.surface_fit, surface_fits,
                  with_default("How the source is laid onto the target",
                               name_of(surface_fits, defaults.fit.surface_fit.method)));
  add_name_option(
      fit, "--boundaries", arguments.boundaries, boundary_rules,
      with_default(
          "deformation-graph: whether open boundaries of the source meet the target's; free when the "
          "models were cut at different places",
          name_of(boundary_rules, defaults.fit.surface_fit.boundaries)));
  fit.add_option("--max-stretch", arguments.max_stretch,
                 with_default("deformation-graph: where a length on the source would grow or shrink by a "
                              "larger factor beyond its coarse deformation, its vertices follow their "
                              "neighbours instead",
                              CLI::detail::to_string(defaults.fit.surface_fit.max_stretch)))
      ->check(CLI::Range(1.01, 1e6))
      ->type_name("FACTOR");
  add_name_option(
      fit, "--elastic", arguments.elastic, elastic_methods,
      with_default("How the fit is carried into space", name_of(elastic_methods, defaults.fit.elastic)));
  add_name_option(
      fit, "--guides", arguments.guides, guided_maps,
      with_default("multiscale, diffeomorphic: maps that take space off the surface along with it as a "
                   "rigid body, so that a loose sleeve turns with its arm; steps are those of chains",
                   name_of(guided_maps, defaults.fit.guides)));
  add_name_option(fit, "--path", arguments.path, rotation_paths,
                  "How the motion goes with t; stored in the asset (default: flow for a map of several "
                  "steps, else geodesic)");
  fit.add_option(
         "--steps", arguments.steps,
         "Steps of the chain that the map is made of (default: 1 for models in about the same pose, else by "
         "the largest turn of a part; more where fewer would fold or miss vertices). One remains one; of "
         "more, those that fold when baked, or are foreseen to, are divided")
      ->check(CLI::Range(1, 100))
      ->type_name("N");
  add_name_option(
      fit, "--nodes", arguments.nodes, node_values,
      with_default("What the nodes of nested levels hold: the map's own values, or values between "
                   "which interpolation errs as far to either side, in a third fewer voxels",
                   name_of(node_values, defaults.bake.nodes)));
  fit.add_flag(
      "--paper", arguments.paper,
      "The printed method: --surface-fit laplacian with nothing added to Eq. 11-15, --elastic csrbf, --path "
      "euler, --steps 1, --contact-offset 0, --nodes sampled, --as-given, and pairs met exactly that have "
      "neither a sigma nor a weight");
  fit.add_flag("--as-given", arguments.as_given,
               "Take the models as they are: by default edges that a file cuts open at the same places are "
               "joined, and a target that is inside out is turned over");
  fit.add_flag(
      "--any-size", arguments.any_size,
      "Take models that differ by more than eight times in size, which are refused else as if in two "
      "units: the map then goes from one unit to the other");
  fit.add_flag("--add-corners", arguments.add_corners,
               "Add the eight corners of the bounding boxes of the two models, aligned, as anchor pairs");
}

void add_length_options(CLI::App& fit, FitArguments& arguments) {
  const auto defaulted = [](const std::string& text, double fraction) {
    return text +
           ", mesh units or % of the source's bounding-box diagonal (default: " + percentage(fraction) + ")";
  };
  const auto on_target = [&](const std::string& text, double fraction) {
    return defaulted(text, fraction) + ", doubled or halved as often as the target is twice or half as large";
  };
  add_length_option(
      fit, "--lambda", arguments.lambda,
      defaulted("Effective distance: how far from the source the elastic part reaches", default_lambda));
  add_length_option(fit, "--tolerance", arguments.tolerance,
                    on_target("Largest difference between the baked and the exact map", default_tolerance));
  add_length_option(fit, "--fit-tolerance", arguments.fit_tolerance,
                    on_target("The multiscale and diffeomorphic maps refine where the fit is missed by more",
                              default_fit_tolerance));
  add_length_option(
      fit, "--anchor-sigma", arguments.anchor_sigma,
      "Accuracy of the anchors that have neither a sigma nor a weight of their own: standard "
      "deviation of a coordinate, mesh units or % of the diagonal; 0 meets them exactly (default: "
      "estimated from their distance to the target)",
      LengthRange::not_negative);
  add_length_option(
      fit, "--contact-offset", arguments.contact_offset,
      on_target("Where the target touches itself, the parts are held this far apart; 0 leaves them",
                default_contact_offset),
      LengthRange::not_negative);
  add_length_option(
      fit, "--voxel-size", arguments.voxel_size,
      "Bake one uniform level of this voxel size, mesh units or % of the diagonal (default: nested "
      "levels that meet --tolerance)");
}

void add_file_options(CLI::App& fit, FitArguments& arguments) {
  fit.add_option("SOURCE", arguments.source,
                 "Reference model that products are designed around: " + read_product_endings())
      ->required();
  fit.add_option("TARGET", arguments.target, "Reference model that products shall fit")->required();
  fit.add_option("--anchors", arguments.anchors,
                 "Pairs of corresponding points, JSON (also curves and patches) or CSV (default: models in "
                 "similar pose are aligned by "
                 "their surfaces, or refused)")
      ->type_name("FILE");
  fit.add_option("-o,--output", arguments.output, "Asset to write")->required()->type_name("MAP.vdb");
  fit.add_option("--fitted", arguments.fitted,
                 "The source already laid onto the target (same connectivity); skips surface fitting")
      ->type_name("MESH");
  fit.add_option("--fitted-out", arguments.fitted_out, "Write the source as laid onto the target")
      ->type_name("MESH");
  fit.add_option("--confidence-out", arguments.confidence_out,
                 "Write how well each source vertex found its counterpart, 0 to 1, one line a vertex")
      ->type_name("FILE");
  fit.add_flag("--require-certified", arguments.require_certified,
               "Write nothing unless the map is proved to be a bijection of space");
  fit.add_flag(
      "--strict", arguments.strict,
      "Meet the tolerance everywhere or refuse, for want of memory; by default a map that would take more "
      "than 4.2 M voxels keeps to these, and the regions where it misses the tolerance are named "
      "(implied by --tolerance)");
  fit.add_flag("--half", arguments.half, half_help);
  fit.add_flag("--keep-exact", arguments.keep_exact,
               "Store in the asset what `apply --exact` needs to evaluate the map without the grids");
  fit.add_option("--report", arguments.report,
                 "Write residuals, iterations, seconds, counts and memory as JSON")
      ->type_name("FILE");
  fit.add_option("--html", arguments.html, "Write a page that shows the map, as `view`, and an index of it")
      ->type_name("DIR");
}

}  // namespace

void add_fit_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<FitArguments>();
  CLI::App* fit = app.add_subcommand("fit", "Compute the map between two reference models and store it");
  add_file_options(*fit, *arguments);
  add_method_options(*fit, *arguments);
  add_length_options(*fit, *arguments);
  add_memory_option(*fit, arguments->max_memory,
                    "Bytes that a stage may take, for instance 4GiB (default: 8GiB)");
  add_run_options(*fit, arguments->run);
  fit->footer(
      "Examples:\n"
      "  bespoke fit woman.obj man.obj --anchors pairs.json -o map.vdb\n"
      "  bespoke fit woman.obj man.obj -o map.vdb\n"
      "  bespoke fit woman.obj man.obj --anchors pairs.csv -o map.vdb --paper --lambda 5%\n"
      "  bespoke fit woman.obj man.obj --fitted woman_on_man.obj -o map.vdb --report report.json");
  fit->callback([arguments, handle_plan] {
    const FitArguments given = std::exchange(*arguments, {});
    require_consistent(given);
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
