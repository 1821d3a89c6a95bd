#include <memory>
#include <optional>
#include <utility>

#include "bespoke/asset/asset_io.h"
#include "bespoke/catalog/difference_report.h"
#include "bespoke/error.h"
#include "commands.h"
#include "help.h"
#include "length_option.h"
#include "map_models.h"
#include "output_files.h"
#include "pose_option.h"

namespace bespoke::command {
namespace {

struct DiffArguments {
  std::string a, b;
  std::vector<std::string> products;
  std::string output;
  std::optional<Length> within;
  std::optional<ModelPose> pose;  ///< of skinned products
  bool json = false;
  bool untrusted = false;
  RunOptions run;
};

std::vector<JobFile> inputs(const DiffArguments& arguments) {
  std::vector<JobFile> files{{"a", arguments.a}, {"b", arguments.b}};
  for (const std::string& product : arguments.products) files.push_back({"product", product});
  return files;
}

std::vector<JobFile> outputs(const DiffArguments& arguments) {
  return named_files({{"output", arguments.output}});
}

void require_one_unit(const DiffArguments& arguments, const Asset& a, const Asset& b) {
  const std::string &unit_a = a.record.unit, &unit_b = b.record.unit;
  if (unit_a != unit_b && unit_a != "unknown" && unit_b != "unknown")
    throw InvalidInput(arguments.a + " is in " + unit_a + ", " + arguments.b + " in " + unit_b +
                       ": their lengths cannot be compared");
}

void require_within(const DiffArguments& arguments, const Asset& a, const PointDifference& difference) {
  if (!arguments.within) return;
  const double limit = arguments.within->in_mesh_units(a.record.source.box.diagonal().norm());
  if (!(difference.distance.max <= limit))
    throw SolverError(arguments.a + " and " + arguments.b + " are " +
                      std::to_string(difference.distance.max) + " apart, more than " + std::to_string(limit));
}

void run(const DiffArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs(arguments), outputs(arguments));
  const Asset a = read_asset(arguments.a, {.untrusted = arguments.untrusted});
  const Asset b = read_asset(arguments.b, {.untrusted = arguments.untrusted});
  require_one_unit(arguments, a, b);
  std::vector<Points> products;
  for (const std::string& product : arguments.products)
    products.push_back(
        read_product_in(product, a.record.unit, "", arguments.pose.value_or(ModelPose::shown)).mesh.vertices);
  ComparedMaps compared{a, b, map_difference(a, b, products, context.progress), record_difference(a, b),
                        arguments.products};
  if (a.record.source.hash != b.record.source.hash)
    context.warn(
        "the maps have different sources, so their places correspond only as far as these do; fit both "
        "from one source to compare them everywhere",
        Entry::maps_of_different_sources);
  write_result(arguments.output, arguments.json ? difference_json(compared) : difference_text(compared),
               context);
  context.findings.figures = {{"largest", compared.maps.band.distance.max},
                              {"p99", compared.maps.band.distance.p99},
                              {"same_records", compared.records.is_empty()}};
  require_within(arguments, a, compared.maps.band);
}

}  // namespace

void add_diff_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* diff = app.add_subcommand("diff", "Say how far two maps take the same points apart, and why");
  begin_group(*diff, input_group);
  diff->add_option("A", arguments->a, map_help)->required();
  diff->add_option("B", arguments->b, "Another map of the same source")->required();
  diff->add_option("--product", arguments->products, "Also say how far its vertices end up apart; repeatable")
      ->type_name("MESH")
      ->allow_extra_args(false);
  add_pose_option(*diff, arguments->pose, "skinned glTF products");
  diff->add_flag("--untrusted", arguments->untrusted, untrusted_help);
  begin_group(*diff, quality_group);
  add_length_option(*diff, "--within", arguments->within,
                    "Exit with code 3 unless they are no farther apart than this (default: any distance)",
                    LengthRange::not_negative);
  begin_group(*diff, output_group);
  diff->add_option("-o,--output", arguments->output, printed_output_help)->type_name("FILE");
  diff->add_flag("--json", arguments->json, json_help);
  add_run_options(*diff, arguments->run);
  diff->footer(
      "Distances are measured at 300,000 random points, half of them in the band of each map, more where a "
      "map is "
      "stored finely.\n\n"
      "Examples:\n"
      "  bespoke diff before.vdb after.vdb\n"
      "  bespoke diff before.vdb after.vdb --product dress.obj --within 0.1%");
  diff->callback([arguments, handle_plan] {
    const DiffArguments given = std::exchange(*arguments, {});
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
