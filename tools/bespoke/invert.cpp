#include <cstdio>
#include <memory>
#include <optional>

#include "bespoke/asset/asset_io.h"
#include "bespoke/pipeline/derive_map.h"
#include "commands.h"
#include "length_option.h"
#include "output_files.h"
#include "run_options.h"

namespace bespoke::command {
namespace {

struct InvertArguments {
  std::string map;
  std::string output;
  std::optional<Length> tolerance;
  bool untrusted = false;
  RunOptions run;
};

void run(const InvertArguments& arguments, const Progress& progress) {
  require_safe_outputs({arguments.map}, {arguments.output});
  const Asset asset = read_asset(arguments.map, {.untrusted = arguments.untrusted});
  BakeOptions options;
  options.tolerance = arguments.tolerance
                          ? arguments.tolerance->in_mesh_units(asset.record.target.box.diagonal().norm())
                          : asset.record.tolerance;
  const DerivedMap derived = invert_map(asset, options, progress);
  OutputFiles outputs;
  outputs.write(arguments.output, [&](const auto& path) { write_asset(path, derived.asset); });
  outputs.keep();
  if (arguments.run.quiet) return;
  std::printf("%-12s %s\n", "bake", to_string(derived.bake).c_str());
  std::printf("%-12s %s\n", "certificate", to_string(derived.asset.certificate).c_str());
  std::printf("%-12s %s\n", "round trip", to_string(derived.deviation).c_str());
  std::printf("%-12s %s\n", "written", arguments.output.c_str());
}

}  // namespace

void add_invert_command(CLI::App& app) {
  auto arguments = std::make_shared<InvertArguments>();
  CLI::App* invert = app.add_subcommand("invert", "Make the map from the target back to the source");
  invert->add_option("MAP", arguments->map, "Asset of a map that is certified as a bijection")->required();
  invert->add_option("-o,--output", arguments->output, "Asset to write")->required()->type_name("MAP.vdb");
  add_length_option(*invert, "--tolerance", arguments->tolerance,
                    "Largest difference between the baked and the exact inverse, mesh units or % of the "
                    "target's bounding-box diagonal (default: that of MAP)");
  invert->add_flag("--untrusted", arguments->untrusted,
                   "Check the asset in a child process under limits first");
  add_run_options(*invert, arguments->run);
  invert->footer(
      "Examples:\n"
      "  bespoke invert woman_to_man.vdb -o man_to_woman.vdb\n"
      "  bespoke invert ab.vdb -o ba.vdb --tolerance 0.01%");
  invert->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
