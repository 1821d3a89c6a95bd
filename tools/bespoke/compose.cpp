#include <algorithm>
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

struct ComposeArguments {
  std::string first;
  std::string second;
  std::string output;
  std::optional<Length> tolerance;
  bool any_models = false;
  bool untrusted = false;
  RunOptions run;
};

void run(const ComposeArguments& arguments, const Progress& progress) {
  require_safe_outputs({arguments.first, arguments.second}, {arguments.output});
  const Asset first = read_asset(arguments.first, {.untrusted = arguments.untrusted});
  const Asset second = read_asset(arguments.second, {.untrusted = arguments.untrusted});
  BakeOptions options;
  options.tolerance = arguments.tolerance
                          ? arguments.tolerance->in_mesh_units(first.record.source.box.diagonal().norm())
                          : std::max(first.record.tolerance, second.record.tolerance);
  const DerivedMap derived = compose_maps(
      first, second, options,
      arguments.any_models ? MeetingModels::may_differ : MeetingModels::must_be_the_same, progress);
  OutputFiles outputs;
  outputs.write(arguments.output, [&](const auto& path) { write_asset(path, derived.asset); });
  outputs.keep();
  if (arguments.run.quiet) return;
  std::printf("%-12s %s\n", "bake", to_string(derived.bake).c_str());
  std::printf("%-12s %s\n", "certificate", to_string(derived.asset.certificate).c_str());
  std::printf("%-12s %s\n", "deviation", to_string(derived.deviation).c_str());
  std::printf("%-12s %s\n", "written", arguments.output.c_str());
}

}  // namespace

void add_compose_command(CLI::App& app) {
  auto arguments = std::make_shared<ComposeArguments>();
  CLI::App* compose = app.add_subcommand("compose", "Join two maps into one: a to c from a to b and b to c");
  compose->add_option("AB", arguments->first, "Asset of the map from a to b")->required();
  compose->add_option("BC", arguments->second, "Asset of the map from b to c")->required();
  compose->add_option("-o,--output", arguments->output, "Asset to write")->required()->type_name("MAP.vdb");
  add_length_option(*compose, "--tolerance", arguments->tolerance,
                    "Largest difference between the joined map and the two, mesh units or % of a's "
                    "bounding-box diagonal (default: the larger one of AB and BC)");
  compose->add_flag("--any-models", arguments->any_models,
                    "Join maps even if the model that AB leads to is not the one that BC starts from");
  compose->add_flag("--untrusted", arguments->untrusted,
                    "Check the assets in a child process under limits first");
  add_run_options(*compose, arguments->run);
  compose->footer(
      "Examples:\n"
      "  bespoke compose ab.vdb bc.vdb -o ac.vdb\n"
      "  bespoke compose ab.vdb bc.vdb -o ac.vdb --tolerance 0.01%");
  compose->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
