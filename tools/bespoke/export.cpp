#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/exchange/glb_file.h"
#include "bespoke/exchange/image_formats.h"
#include "bespoke/number_format.h"
#include "bespoke/pipeline/open_map.h"
#include "bespoke/product/format_unit.h"
#include "bespoke/unknown_ending.h"
#include "commands.h"
#include "help.h"
#include "length_option.h"
#include "name_option.h"
#include "output_files.h"
#include "run_options.h"

namespace bespoke::command {
namespace {

struct ExportArguments {
  std::string map;
  std::string output;
  std::optional<Length> grid;
  std::optional<int> morph;
  std::string product;
  std::optional<WorldSpace> space;
  bool pull = false;
  bool untrusted = false;
  RunOptions run;
};

constexpr int max_targets = 1000;
constexpr std::size_t error_points = 200'000;

// Of the values, bytes.
constexpr std::size_t max_memory = std::size_t{8} << 30;

/// The model's box, and around it what the elastic part reaches.
Box reached(const Box& model, double lambda) {
  return {model.min() - Vector3::Constant(lambda), model.max() + Vector3::Constant(lambda)};
}

std::string content(const ExportArguments& arguments, const AssetRecord& record) {
  const std::string unit = record.unit.empty() ? "unknown unit" : record.unit;
  return std::string("displacements of a bespoke map, added to points of the ") +
         (arguments.pull ? "target they give points of the source, "
                         : "source they give points of the target, ") +
         unit;
}

std::vector<JobFile> inputs(const ExportArguments& arguments) {
  return named_files({{"map", arguments.map}, {"product", arguments.product}});
}

std::vector<JobFile> outputs(const ExportArguments& arguments) { return {{"output", arguments.output}}; }

void require_image_arguments(const ExportArguments& arguments) {
  require_image_ending(arguments.output);
  if (arguments.space && !says_world_space(arguments.output))
    throw CLI::ValidationError(
        "--space",
        arguments.output + " does not say which way its axes point: it is in the models' own frame");
}

void export_grid(const ExportArguments& arguments, const RunContext& context) {
  const Progress& progress = context.progress;
  const ReadAssetOptions reading{.untrusted = arguments.untrusted};
  const AssetRecord record = read_asset(arguments.map, reading).record;
  const OpenedMap map = open_map(arguments.map, arguments.pull ? MapForm::inverse : MapForm::grids, reading);
  const PointFunction image = [&](const Points& x) {
    return apply_mapping(*map.elastic, map.target_from_source, x, {1.0}, {map.path}).frames.front();
  };
  const Box box = reached(arguments.pull ? record.target.box : record.source.box, record.lambda);
  const double spacing = arguments.grid->in_mesh_units(record.source.box.diagonal().norm());
  const DisplacementImage sampled = sample_displacements(image, box, spacing, max_memory, progress);
  const Statistics error = sampling_error(sampled, image, box, error_points, progress);

  OutputFiles files;
  const ImageNotes notes{content(arguments, record), arguments.space.value_or(WorldSpace::lps)};
  files.write(arguments.output, [&](const auto& path) { write_displacement_image(path, sampled, notes); });
  files.keep();
  context.findings.figures = {{"nodes", sampled.size[0] * sampled.size[1] * sampled.size[2]},
                              {"error_p99", error.p99},
                              {"error_max", error.max}};
  if (arguments.run.quiet) return;
  std::printf("%-12s %zu x %zu x %zu nodes, voxel %.4g\n", "grid", sampled.size[0], sampled.size[1],
              sampled.size[2], sampled.spacing);
  std::printf("%-12s %s\n", "error", to_string(error).c_str());
  std::printf("%-12s %s\n", "written", arguments.output.c_str());
}

bool is_glb(const std::filesystem::path& path) { return path.extension() == ".glb"; }

void require_morph_arguments(const ExportArguments& arguments) {
  if (!is_glb(arguments.output)) throw UnknownEnding("--morph: " + arguments.output + " must end in .glb");
  if (arguments.product.empty()) throw CLI::ValidationError("--morph", "--product MESH says what morphs");
  if (!is_glb(arguments.product)) require_mesh_ending("--product", arguments.product);
}

/// Faces, and the name of their unit.
struct MorphedFaces {
  Product product;
  std::string unit;
};

/// In metres where their unit is known. Returns how far straight pieces are off.
double export_faces(const ExportArguments& arguments, const OpenedMap& map, const MorphedFaces& faces,
                    const std::filesystem::path& output) {
  const std::string& own_unit = faces.product.unit.empty() ? faces.unit : faces.product.unit;
  const MorphingMesh mesh =
      morph_along(faces.product, *map.elastic, map.target_from_source, *arguments.morph, {map.path});
  write_glb(output, mesh,
            {std::filesystem::path(arguments.product).stem().string(), metres_per_unit(own_unit)});
  return mesh.off_path;
}

/// Of a .glb, as it is. Returns the same.
double export_file(const ExportArguments& arguments, const OpenedMap& map,
                   const std::filesystem::path& output, const RunContext& context) {
  const MorphSummary summary =
      morph_file_along(arguments.product, output, *map.elastic, map.target_from_source,
                       {*arguments.morph, {map.path}, context.progress});
  for (const std::string& warning : summary.warnings)
    context.warn(arguments.product + ": " + warning, Entry::content_left_as_it_is);
  return summary.off_path;
}

void export_morph(const ExportArguments& arguments, const RunContext& context) {
  const ReadAssetOptions reading{.untrusted = arguments.untrusted};
  const std::string unit = read_asset(arguments.map, reading).record.unit;
  const double scale = scale_to_unit(arguments.product, unit);
  const OpenedMap map = in_other_unit(open_map(arguments.map, MapForm::grids, reading), scale);
  const bool keeps_file = is_glb(arguments.product);
  MorphedFaces faces{{}, unit};
  if (!keeps_file) faces.product = read_product(arguments.product);
  if (faces.product.degenerate.count > 0)
    context.warn(arguments.product + ": " + to_string(faces.product.degenerate),
                 Entry::content_left_as_it_is);
  OutputFiles files;
  double off_path = 0;
  files.write(arguments.output, [&](const std::filesystem::path& path) {
    off_path =
        keeps_file ? export_file(arguments, map, path, context) : export_faces(arguments, map, faces, path);
  });
  files.keep();
  context.findings.figures = {{"off_path", off_path}};
  if (arguments.run.quiet) return;
  std::printf("%-12s %d, with straight motion between them at most %.4g off the map's\n", "targets",
              *arguments.morph, off_path);
  if (scale != 1)
    std::printf("%-12s %s of the map; the product is in %s: times %s\n", "unit", unit.c_str(),
                unit_of_format(arguments.product).c_str(), format_number(scale, 6).c_str());
  else if (keeps_file)
    std::printf("%-12s %s, taken as that of the scene\n", "unit", unit.empty() ? "unknown" : unit.c_str());
  else if (metres_per_unit(unit))
    std::printf("%-12s %s, shown in metres\n", "unit", unit.c_str());
  else
    std::printf("%-12s %s, shown as if they were metres\n", "unit", unit.empty() ? "unknown" : unit.c_str());
  std::printf("%-12s %s%s\n", "written", arguments.output.c_str(),
              keeps_file ? "" : ", without groups and materials");
}

void require_valid(const ExportArguments& arguments) {
  if (arguments.grid.has_value() == arguments.morph.has_value())
    throw CLI::ValidationError("export", "give either --grid LENGTH or --morph N");
  arguments.grid ? require_image_arguments(arguments) : require_morph_arguments(arguments);
}

void run(const ExportArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs(arguments), outputs(arguments));
  arguments.grid ? export_grid(arguments, context) : export_morph(arguments, context);
}

}  // namespace

void add_export_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* exported =
      app.add_subcommand("export", "Write a map as a displacement image, or as morph targets of a product");
  begin_group(*exported, input_group);
  exported->add_option("MAP", arguments->map, map_help)->required();
  exported->add_flag("--untrusted", arguments->untrusted, untrusted_help);
  begin_group(*exported, output_group);
  exported
      ->add_option("-o,--output", arguments->output,
                   "File to write, by its ending: " + image_endings() + "; with --morph .glb")
      ->required()
      ->type_name("OUT");
  add_length_option(
      *exported, "--grid", arguments->grid,
      "Write an image of this voxel size, mesh units or % of the source's bounding-box diagonal");
  CLI::Option* morph = exported
                           ->add_option("--morph", arguments->morph,
                                        "Write a product with N morph targets, at t = 1/N, 2/N, …, 1, and an "
                                        "animation through them, as .glb")
                           ->check(CLI::Range(1, max_targets))
                           ->type_name("N");
  exported
      ->add_option(
          "--product", arguments->product,
          "The mesh that morphs: OBJ, PLY, STL or OFF, of which faces are kept, or .glb, which is kept whole")
      ->needs(morph)
      ->type_name("MESH");
  exported
      ->add_flag("--pull", arguments->pull,
                 "Displacements from the target to the source, which programs that resample images need")
      ->excludes(morph);
  add_name_option(*exported, "--space", arguments->space, world_spaces,
                  "Which way the models' axes point, for .nrrd, which is written in LPS, and .nii.gz, in RAS "
                  "(default: lps)");
  add_run_options(*exported, arguments->run);
  exported->footer(
      "The image covers the model and what the elastic part reaches, and nothing beyond. glTF is in metres: "
      "lengths in m, dm, cm, mm, in or ft are scaled on the node, others are shown as they are.\n\n"
      "Examples:\n"
      "  bespoke export map.vdb --grid 0.5% -o map.vti\n"
      "  bespoke export map.vdb --grid 0.5% -o level.vdb\n"
      "  bespoke export map.vdb --grid 2 --pull --space ras -o map.nrrd\n"
      "  bespoke export map.vdb --morph 8 --product dress.obj -o dress.glb");
  exported->callback([arguments, handle_plan] {
    const ExportArguments given = std::exchange(*arguments, {});
    require_valid(given);
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
