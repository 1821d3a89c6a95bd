#include <chrono>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "apply_plan.h"
#include "bespoke/apply/apply_to_product.h"
#include "bespoke/apply/convert_product.h"
#include "bespoke/atomic_file.h"
#include "bespoke/number_format.h"
#include "bespoke/output_stream.h"
#include "bespoke/product/carry_product.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/product/product_io.h"
#include "bespoke/report/report.h"
#include "bespoke/strings.h"
#include "bespoke/unknown_ending.h"
#include "commands.h"
#include "help.h"
#include "length_option.h"
#include "name_option.h"
#include "output_files.h"
#include "penetration_check.h"
#include "pose_option.h"
#include "product_map.h"
#include "rigid_option.h"
#include "standard_output.h"
#include "time_option.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

std::vector<JobFile> inputs(const ApplyArguments& arguments) {
  std::vector<JobFile> files = named_files({{"map", arguments.map}});
  for (JobFile& file : inputs(arguments.catalog)) files.push_back(std::move(file));
  for (const std::string& product : arguments.products) files.push_back({"product", product});
  if (!arguments.skeleton.empty()) files.push_back({"skeleton", arguments.skeleton});
  return files;
}

std::vector<JobFile> outputs(const ApplyArguments& arguments,
                             const std::vector<std::vector<fs::path>>& plan) {
  std::vector<JobFile> files;
  for (const std::vector<fs::path>& frames : plan)
    for (const fs::path& frame : frames)
      files.push_back({arguments.output.empty() ? "out-dir" : "output", frame});
  if (!arguments.report.empty()) files.push_back({"report", arguments.report});
  return files;
}

std::vector<double> times(const ApplyArguments& arguments) {
  if (!arguments.frames) return {arguments.t};
  std::vector<double> times;
  for (int k = 0; k <= *arguments.frames; ++k) times.push_back(static_cast<double>(k) / *arguments.frames);
  return times;
}

MapForm map_form(const ApplyArguments& arguments) {
  if (arguments.inverse) return MapForm::inverse;
  return arguments.exact ? MapForm::exact : MapForm::grids;
}

/// The map's own path, except for orders that do not know it.
MotionOptions motion_options(const ApplyArguments& arguments, const OpenedMap& map) {
  const MappingOrder order = arguments.order.value_or(MappingOrder::elastic_first);
  RotationPath path = arguments.path.value_or(map.path);
  if (!arguments.path && path == RotationPath::flow && order != MappingOrder::elastic_first)
    path = RotationPath::geodesic;
  return {path, order};
}

std::string conversion(const std::string& name, const std::string& map_unit, double scale,
                       const ApplyArguments& arguments) {
  return "is in " + product_unit(name, map_unit, arguments.unit) + ", the map in " + map_unit +
         ": carried times " + format_number(scale, 6) + " and written in its own unit";
}

struct PlannedProduct {
  const std::string& name;
  const std::vector<fs::path>& outputs;
  std::vector<RigidPart> parts;
};

/// Carries the file as it is or, to become another kind of file, its faces.
ProductSummary apply_one(const ApplyArguments& arguments, const PlannedProduct& product, const OpenedMap& map,
                         const Progress& progress) {
  const std::string& name = product.name;
  const double scale = product_scale(name, map.unit, arguments.unit);
  const OpenedMap own = in_other_unit(map, scale);
  const MotionOptions motion = motion_options(arguments, map);
  const bool measure_chords = !arguments.report.empty() && can_read_product(name);
  std::optional<double> refine;
  if (arguments.refine) refine = arguments.refine->in_mesh_units(map.source_diagonal) / scale;
  std::optional<Box> model_box;
  if (arguments.unit.empty()) model_box = own.model_box;
  std::vector<fs::path> targets;
  for (const fs::path& output : product.outputs) targets.push_back(output_target(output));
  ProductSummary summary;
  if (!is_carried(arguments, name, product.outputs.front())) {
    ConvertOptions options{motion, refine, measure_chords, {}, model_box};
    options.unit = product_unit(name, map.unit, arguments.unit);
    options.times = times(arguments);
    summary = convert_product(name, targets, *own.elastic, own.target_from_source, options);
  } else {
    ApplyToProductOptions options{motion, product.parts, refine, measure_chords, model_box, progress};
    options.pose = arguments.pose.value_or(ModelPose::shown);
    options.times = times(arguments);
    if (!arguments.skeleton.empty()) options.skeleton = arguments.skeleton;
    summary = apply_to_product(name, targets, *own.elastic, own.target_from_source, options);
  }
  if (scale != 1) summary.warnings.push_back(conversion(name, map.unit, scale, arguments));
  return summary;
}

std::vector<JobFigure> figures(const std::vector<AppliedProduct>& applied) {
  std::size_t points = 0, in_band = 0;
  for (const AppliedProduct& product : applied) {
    points += product.summary.points.points;
    in_band += product.summary.points.in_band;
  }
  return {{"products", applied.size()}, {"points", points}, {"in_band", in_band}};
}

void print_summary(const fs::path& output, const ProductSummary& summary, const std::string& skeleton) {
  std::printf("%s: %s\n", output.c_str(), to_string(summary.points).c_str());
  if (summary.joints > 0 && skeleton.empty())
    std::printf("%s: %zu joints carried with their skin\n", output.c_str(), summary.joints);
  else if (summary.joints > 0)
    std::printf("%s: bound to the %zu joints of %s\n", output.c_str(), summary.joints, skeleton.c_str());
  if (summary.chord)
    std::printf("%s: %zu edges split; %s\n", output.c_str(), summary.splits,
                to_string(*summary.chord).c_str());
  for (const PartSummary& part : summary.parts)
    std::printf("%s: %s\n", output.c_str(), to_string(part).c_str());
}

/// The order of the products in which they are corrected.
std::vector<std::size_t> correction_order(ClearanceKeeper& keeper, ProductMap& map,
                                          const std::vector<std::string>& products) {
  std::vector<std::size_t> order;
  map.use(products.front(), [&](const OpenedMap& opened) { order = keeper.order(products, opened); });
  return order;
}

void run(const ApplyArguments& arguments, const RunContext& context) {
  const auto start = std::chrono::steady_clock::now();
  const Progress& progress = context.progress;
  if (!arguments.out_dir.empty() && !writes_are_held()) make_directories(arguments.out_dir);
  const std::vector<std::vector<fs::path>> plan = plan_outputs(arguments);
  require_safe_outputs(inputs(arguments), outputs(arguments, plan));
  const fs::path map_file =
      arguments.catalog.is_used() ? find_map(arguments.catalog) : fs::path(arguments.map);
  const ModelPose pose = arguments.pose.value_or(ModelPose::shown);
  ProductMap map(
      map_file, arguments.products,
      {map_form(arguments), arguments.untrusted,
       arguments.order == MappingOrder::moving_point || arguments.clearance.is_used(), arguments.unit, pose},
      context);
  // A batch knows which jobs share a map only where they name it.
  if (arguments.catalog.is_used()) context.maps.close(map_file);

  const bool reaches_target = !arguments.inverse && times(arguments).back() == 1;
  PenetrationCheck new_penetration(reaches_target ? arguments.catalog.source : "", arguments.catalog.target);
  const PartsOfProducts parts = parts_of_products(arguments.products, arguments.parts, pose);
  ClearanceKeeper keeper(arguments.clearance, parts, arguments.unit, pose);
  OutputFiles files;
  std::vector<AppliedProduct> applied(arguments.products.size());
  std::vector<std::string> penetrations(arguments.products.size());
  const std::vector<std::size_t> order = correction_order(keeper, map, arguments.products);
  std::size_t done = 0;
  for (const std::size_t i : order) {
    progress.step("apply", done++, arguments.products.size());
    const std::string& name = arguments.products[i];
    ProductSummary summary;
    map.use(name, [&](const OpenedMap& opened) {
      const OpenedMap cleared = keeper.corrected(name, opened);
      penetrations[i] = new_penetration(name, cleared, arguments.unit, pose);
      summary = apply_one(arguments, {name, plan[i], parts_of(parts, name)}, cleared, progress);
      if (!penetrations[i].empty()) summary.warnings.push_back(penetrations[i]);
    });
    files.add(plan[i]);
    files.add(summary.companions);
    std::vector<fs::path>& further = context.findings.further_outputs;
    further.insert(further.end(), summary.companions.begin(), summary.companions.end());
    applied[i] = {fs::path(name).filename().string(), std::move(summary), keeper.last()};
  }
  progress.step("apply", arguments.products.size(), arguments.products.size());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!arguments.report.empty())
    files.write_text(arguments.report,
                     apply_report(applied, times(arguments), seconds, keeper.layer_order()));
  files.keep();

  context.findings.figures = figures(applied);
  if (!arguments.run.quiet && !map.reading().empty()) std::printf("%s\n", map.reading().c_str());
  if (keeper.layer_order()) {
    if (!arguments.run.quiet) std::printf("%s\n", to_string(*keeper.layer_order()).c_str());
    warn_of_layers(context, *keeper.layer_order());
  }
  for (std::size_t i = 0; i < applied.size(); ++i) {
    if (!arguments.run.quiet) print_summary(plan[i].back(), applied[i].summary, arguments.skeleton);
    if (!arguments.run.quiet && applied[i].clearance) print_clearance(plan[i].back(), *applied[i].clearance);
    if (applied[i].clearance && !applied[i].clearance->is_clear())
      context.warn(arguments.products[i] + ": " + what_is_not_clear(applied[i].clearance->summary),
                   Entry::product_inside_the_target);
    for (const std::string& warning : applied[i].summary.warnings)
      context.warn(arguments.products[i] + ": " + warning, warning == penetrations[i]
                                                               ? Entry::product_inside_the_target
                                                               : Entry::content_left_as_it_is);
  }
  keeper.require_clear();
}

/// What keeps its shape, and where edges follow the map's.
void add_shape_options(CLI::App& apply, ApplyArguments& arguments) {
  add_part_options(apply, arguments.parts);
  apply
      .add_option(
          "--unit", arguments.unit,
          "Unit of the products' coordinates: mm, cm, m, in …, or map for the map's own; they are carried "
          "and written in it (default: what glTF and 3MF files say, else the map's)")
      ->type_name("UNIT");
  add_length_option(
      apply, "--refine", arguments.refine,
      "Split edges where the map bends them, until the middle of a mapped edge is no farther than this from "
      "the mapped middle; vertex data are interpolated, all else stays (default: no edge is split)");
}

/// What becomes of skeletons.
void add_rig_options(CLI::App& apply, ApplyArguments& arguments) {
  add_pose_option(apply, arguments.pose, "skinned glTF products");
  apply
      .add_option("--skeleton", arguments.skeleton,
                  "A skinned model (.glb, .gltf), the target for instance: the product, a .glb, is bound to "
                  "its skeleton, with the weights of the nearest place of its skin (default: a product's own "
                  "skeleton is carried with it)")
      ->type_name("TARGET");
}

/// The arguments, with products in their place: where the map is found, the first stands in that of the map.
ApplyArguments taken(ApplyArguments& arguments) {
  ApplyArguments given = std::exchange(arguments, {});
  require_valid(given.catalog);
  require_valid(given.clearance);
  if (given.clearance.is_used() && (given.frames || given.t != 1))
    throw CLI::ValidationError("--clearance",
                               "is kept from the target, where --t is 1; leave out --frames and --t");
  if (given.catalog.is_used())
    given.products.insert(given.products.begin(), std::exchange(given.map, {}));
  else if (given.products.empty())
    throw CLI::RequiredError("PRODUCT");
  return given;
}

/// What jobs of a batch hold in memory together.
std::optional<fs::path> shared_map(const ApplyArguments& arguments) {
  return arguments.map.empty() ? std::nullopt : std::optional<fs::path>(arguments.map);
}

}  // namespace

void add_apply_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<ApplyArguments>();
  CLI::App* apply = app.add_subcommand("apply", "Carry products across a map");
  begin_group(*apply, input_group);
  apply->add_option("MAP", arguments->map, "Map made by `bespoke fit`; not with --from")->required();
  apply->add_option("PRODUCT", arguments->products,
                    "Meshes or point sets around the source, by their endings: " + product_endings() +
                        ", or .3mf, whose faces are read and written anew");
  add_catalog_option(*apply, arguments->catalog);
  apply->add_flag("--untrusted", arguments->untrusted, untrusted_help);
  begin_group(*apply, output_group);
  apply->add_option("-o,--output", arguments->output, "File to write, for one product")->type_name("OUT");
  apply->add_option("--out-dir", arguments->out_dir, "Directory to write to; products keep their file names")
      ->type_name("DIR");
  apply->add_option("--report", arguments->report, "Write counts, seconds and memory as JSON")
      ->type_name("FILE");
  begin_group(*apply, method_group);
  CLI::Option* t = add_time_option(*apply, arguments->t,
                                   "How far the map goes: 0 is the source, 1 the target; others extrapolate, "
                                   "and `check --t` says whether that folds (default: 1)");
  apply
      ->add_option("--frames", arguments->frames,
                   "Write N+1 files for t = 0, 1/N, …, 1, from one lookup: OUT_000.obj, OUT_001.obj, …")
      ->check(CLI::Range(1, 100000))
      ->type_name("N")
      ->excludes(t);
  add_name_option(
      *apply, "--path", arguments->path, rotation_paths,
      "How the motion goes with t: the rotation on its geodesic or by its Euler angles and the "
      "elastic part straight, or the flow of a map with several steps (default: as stored in the map)");
  add_name_option(*apply, "--order", arguments->order, mapping_orders,
                  "In which order the rigid and the elastic part act; all but the first are for comparison "
                  "(default: elastic-first)");
  CLI::Option* exact = apply->add_flag("--exact", arguments->exact,
                                       "Evaluate the exact map that --keep-exact stored, not the grids");
  apply
      ->add_flag("--inverse", arguments->inverse,
                 "Carry products of the target back to the source; the map must be proved one-to-one")
      ->excludes(exact);
  add_shape_options(*apply, *arguments);
  add_rig_options(*apply, *arguments);
  add_clearance_options(*apply, arguments->clearance);
  add_require_clear(*apply, arguments->clearance);
  add_run_options(*apply, arguments->run);
  apply->footer(
      "Examples:\n"
      "  bespoke apply map.vdb dress.obj -o dress_on_man.obj\n"
      "  bespoke apply map.vdb dress.obj shoes.ply --out-dir fitted\n"
      "  bespoke apply map.vdb dress.obj --out-dir frames --frames 24\n"
      "  bespoke apply map.vdb jacket.glb --skeleton avatar.glb -o jacket_on_avatar.glb\n"
      "  bespoke apply map.vdb shirt.obj jacket.obj --clearance keep --layers --out-dir fitted\n"
      "  bespoke apply dress.obj --from season --source woman.obj -o dress_on_man.obj");
  apply->callback([arguments, handle_plan] {
    const ApplyArguments given = taken(*arguments);
    handle_plan({given.run, inputs(given), outputs(given, plan_outputs(given)), shared_map(given),
                 [given](const RunContext& context) { run(given, context); }});
  });
}

}  // namespace bespoke::command
