#include <cstdio>
#include <memory>
#include <optional>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/exchange/image_formats.h"
#include "bespoke/pipeline/open_map.h"
#include "commands.h"
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
  std::optional<WorldSpace> space;
  bool pull = false;
  bool untrusted = false;
  RunOptions run;
};

constexpr std::size_t error_points = 200'000;

// Of the values, bytes.
constexpr std::size_t most_memory = std::size_t{8} << 30;

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

void run(const ExportArguments& arguments, const Progress& progress) {
  require_image_ending(arguments.output);
  if (arguments.space && !says_world_space(arguments.output))
    throw CLI::ValidationError(
        "--space",
        arguments.output + " does not say which way its axes point: it is in the models' own frame");
  require_safe_outputs({arguments.map}, {arguments.output});
  const ReadAssetOptions reading{.untrusted = arguments.untrusted};
  const AssetRecord record = read_asset(arguments.map, reading).record;
  const OpenedMap map = open_map(arguments.map, arguments.pull ? MapForm::inverse : MapForm::grids, reading);
  const PointFunction image = [&](const Points& x) {
    return apply_mapping(*map.elastic, map.target_from_source, x, {1.0}, {map.path}).frames.front();
  };
  const Box box = reached(arguments.pull ? record.target.box : record.source.box, record.lambda);
  const double spacing = arguments.grid->in_mesh_units(record.source.box.diagonal().norm());
  const DisplacementImage sampled = sample_displacements(image, box, spacing, most_memory, progress);
  const Statistics error = sampling_error(sampled, image, box, error_points, progress);

  OutputFiles outputs;
  const ImageNotes notes{content(arguments, record), arguments.space.value_or(WorldSpace::lps)};
  outputs.write(arguments.output, [&](const auto& path) { write_displacement_image(path, sampled, notes); });
  outputs.keep();
  if (arguments.run.quiet) return;
  std::printf("%-12s %zu x %zu x %zu nodes, voxel %.4g\n", "grid", sampled.size[0], sampled.size[1],
              sampled.size[2], sampled.spacing);
  std::printf("%-12s %s\n", "error", to_string(error).c_str());
  std::printf("%-12s %s\n", "written", arguments.output.c_str());
}

}  // namespace

void add_export_command(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* exported = app.add_subcommand("export", "Write a map as a displacement image for other programs");
  exported->add_option("MAP", arguments->map, "Asset made by `bespoke fit`")->required();
  exported->add_option("-o,--output", arguments->output, "File to write, by its ending: " + image_endings())
      ->required()
      ->type_name("OUT");
  add_length_option(*exported, "--grid", arguments->grid,
                    "Voxel size, mesh units or % of the source's bounding-box diagonal")
      ->required();
  exported->add_flag(
      "--pull", arguments->pull,
      "Displacements from the target to the source, as programs that resample images ask for them");
  add_name_option(*exported, "--space", arguments->space, world_spaces,
                  "Which way the models' axes point, for .nrrd, which is written in LPS, and .nii.gz, in RAS "
                  "(default: lps)");
  exported->add_flag("--untrusted", arguments->untrusted,
                     "Check the asset in a child process under limits first");
  add_run_options(*exported, arguments->run);
  exported->footer(
      "The image covers the model and what the elastic part reaches, and says nothing beyond.\n\n"
      "Examples:\n"
      "  bespoke export map.vdb --grid 0.5% -o map.vti\n"
      "  bespoke export map.vdb --grid 0.5% -o level.vdb\n"
      "  bespoke export map.vdb --grid 2 --pull --space ras -o map.nrrd");
  exported->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
