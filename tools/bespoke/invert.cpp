#include <memory>
#include <utility>

#include "bespoke/asset/asset_io.h"
#include "commands.h"
#include "derived_map_options.h"
#include "help.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

struct InvertArguments {
  std::string map;
  DerivedMapOptions options;
};

std::vector<JobFile> inputs(const InvertArguments& arguments) { return {{"map", arguments.map}}; }

std::vector<JobFile> outputs(const InvertArguments& arguments) {
  return {{"output", arguments.options.output}};
}

void run(const InvertArguments& arguments, const RunContext& context) {
  const DerivedMapOptions& options = arguments.options;
  require_safe_outputs(inputs(arguments), outputs(arguments));
  require_map_ending(options.output);
  const Asset asset = read_asset(arguments.map, {.untrusted = options.untrusted});
  const BakeOptions bake = options.bake(tolerance_of_inverse(asset));
  write_derived_map(options, context, invert_map(asset, bake, context.progress), "round trip");
}

}  // namespace

void add_invert_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<InvertArguments>();
  CLI::App* invert = app.add_subcommand(
      "invert", "Make the map from the target back to the source (`apply --inverse` goes back without one)");
  begin_group(*invert, input_group);
  invert->add_option("MAP", arguments->map, "Map that is proved to be one-to-one")->required();
  add_derived_map_options(*invert, arguments->options,
                          "Largest difference between the baked and the exact inverse, mesh units or % of "
                          "the target's bounding-box diagonal (default: that of MAP, within 4.2 M voxels), "
                          "scaled with the source's size in powers of two");
  invert->footer(
      "Examples:\n"
      "  bespoke invert woman_to_man.vdb -o man_to_woman.vdb\n"
      "  bespoke invert ab.vdb -o ba.vdb --tolerance 0.01%");
  invert->callback([arguments, handle_plan] {
    const InvertArguments given = std::exchange(*arguments, {});
    handle_plan({given.options.run, inputs(given), outputs(given), {}, [given](const RunContext& context) {
                   run(given, context);
                 }});
  });
}

}  // namespace bespoke::command
