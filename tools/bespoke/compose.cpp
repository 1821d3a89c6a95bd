#include <memory>
#include <utility>

#include "bespoke/asset/asset_io.h"
#include "commands.h"
#include "derived_map_options.h"
#include "help.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

struct ComposeArguments {
  std::string first;
  std::string second;
  bool any_models = false;
  DerivedMapOptions options;
};

std::vector<JobFile> inputs(const ComposeArguments& arguments) {
  return {{"ab", arguments.first}, {"bc", arguments.second}};
}

std::vector<JobFile> outputs(const ComposeArguments& arguments) {
  return {{"output", arguments.options.output}};
}

void run(const ComposeArguments& arguments, const RunContext& context) {
  const DerivedMapOptions& options = arguments.options;
  require_safe_outputs(inputs(arguments), outputs(arguments));
  require_map_ending(options.output);
  const Asset first = read_asset(arguments.first, {.untrusted = options.untrusted});
  const Asset second = read_asset(arguments.second, {.untrusted = options.untrusted});
  const BakeOptions bake = options.bake(tolerance_of_composed(first, second));
  const MeetingModels meeting =
      arguments.any_models ? MeetingModels::may_differ : MeetingModels::must_be_the_same;
  write_derived_map(options, context, compose_maps(first, second, bake, meeting, context.progress),
                    "deviation");
}

}  // namespace

void add_compose_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<ComposeArguments>();
  CLI::App* compose =
      app.add_subcommand("compose", "Compose two maps into one: a to c from a to b and b to c");
  begin_group(*compose, input_group);
  compose->add_option("AB", arguments->first, "Map from a to b")->required();
  compose->add_option("BC", arguments->second, "Map from b to c")->required();
  compose->add_flag("--any-models", arguments->any_models,
                    "Compose them even if the target of AB is not the source of BC");
  add_derived_map_options(
      *compose, arguments->options,
      "Largest difference between the composed map and the two, mesh units or % of a's bounding-box diagonal "
      "(default: the larger one of AB and BC, within 4.2 M voxels), scaled with c's size in powers of two");
  compose->footer(
      "Examples:\n"
      "  bespoke compose ab.vdb bc.vdb -o ac.vdb\n"
      "  bespoke compose ab.vdb bc.vdb -o ac.vdb --tolerance 0.01%");
  compose->callback([arguments, handle_plan] {
    const ComposeArguments given = std::exchange(*arguments, {});
    handle_plan({given.options.run, inputs(given), outputs(given), {}, [given](const RunContext& context) {
                   run(given, context);
                 }});
  });
}

}  // namespace bespoke::command
