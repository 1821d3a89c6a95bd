#include <memory>

#include "bespoke/asset/asset_io.h"
#include "commands.h"
#include "derived_map_options.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

struct InvertArguments {
  std::string map;
  DerivedMapOptions options;
};

void run(const InvertArguments& arguments, const Progress& progress) {
  const DerivedMapOptions& options = arguments.options;
  require_safe_outputs({arguments.map}, {options.output});
  const Asset asset = read_asset(arguments.map, {.untrusted = options.untrusted});
  const BakeOptions bake = options.bake(asset.record.target, asset.record.tolerance);
  write_derived_map(options, invert_map(asset, bake, progress), "round trip");
}

}  // namespace

void add_invert_command(CLI::App& app) {
  auto arguments = std::make_shared<InvertArguments>();
  CLI::App* invert = app.add_subcommand("invert", "Make the map from the target back to the source");
  invert->add_option("MAP", arguments->map, "Asset of a map that is certified as a bijection")->required();
  add_derived_map_options(*invert, arguments->options,
                          "Largest difference between the baked and the exact inverse, mesh units or % of "
                          "the target's bounding-box diagonal (default: that of MAP)");
  invert->footer(
      "Examples:\n"
      "  bespoke invert woman_to_man.vdb -o man_to_woman.vdb\n"
      "  bespoke invert ab.vdb -o ba.vdb --tolerance 0.01%");
  invert->callback([arguments] {
    run_with(arguments->options.run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
