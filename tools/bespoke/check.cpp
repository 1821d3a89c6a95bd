#include <memory>
#include <sstream>
#include <utility>

#include "bespoke/asset/asset_io.h"
#include "bespoke/error.h"
#include "bespoke/number_format.h"
#include "bespoke/pipeline/certify_map.h"
#include "bespoke/pipeline/summary_json.h"
#include "commands.h"
#include "help.h"
#include "output_files.h"
#include "time_option.h"

namespace bespoke::command {
namespace {

struct CheckArguments {
  std::string map;
  std::string output;
  double t = 1;
  bool json = false;
  bool untrusted = false;
  RunOptions run;
};

constexpr std::size_t printed_places = 10;

std::vector<JobFile> inputs(const CheckArguments& arguments) { return {{"map", arguments.map}}; }

std::vector<JobFile> outputs(const CheckArguments& arguments) {
  return named_files({{"output", arguments.output}});
}

void print_places(const Certificate& certificate, std::ostream& out) {
  const std::size_t count = std::min(printed_places, certificate.places.size());
  for (std::size_t i = 0; i < count; ++i)
    out << "  level " << certificate.places[i].level << " at " << certificate.places[i].center.transpose()
        << ": det " << certificate.places[i].determinant << '\n';
  if (certificate.places.size() > count)
    out << "  and " << certificate.folded + certificate.undecided - count << " more\n";
}

std::string text_of(const CheckArguments& arguments, const Certificate& certificate) {
  if (arguments.json) return to_json(certificate).dump(2) + "\n";
  std::ostringstream text;
  text << (certificate.is_bijection() ? "proved: the map is one-to-one in all of space"
                                      : "NOT PROVED: the map may fold")
       << " at t = " << arguments.t << '\n'
       << to_string(certificate) << '\n';
  print_places(certificate, text);
  return text.str();
}

void run(const CheckArguments& arguments, const RunContext& context) {
  require_safe_outputs(inputs(arguments), outputs(arguments));
  const Asset asset = read_asset(arguments.map, {.untrusted = arguments.untrusted});
  const Certificate certificate = certify_map(asset, arguments.t, context.progress);
  write_result(arguments.output, text_of(arguments, certificate), context);
  context.findings.figures = {{"bijection", certificate.is_bijection()},
                              {"min_determinant", certificate.min_determinant},
                              {"folded", certificate.folded},
                              {"undecided", certificate.undecided}};
  if (!certificate.is_bijection())
    throw SolverError(
        with_entry(arguments.map + ": not proved to be one-to-one at t = " + format_number(arguments.t, 6) +
                       "; fit again with more anchors at these places or a larger --contact-offset",
                   Entry::not_proved));
}

}  // namespace

void add_check_command(CLI::App& app, const PlanHandler& handle_plan) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* check = app.add_subcommand(
      "check", "Prove from the file alone that a map does not fold, or list where it does");
  begin_group(*check, input_group);
  check->add_option("MAP", arguments->map, map_help)->required();
  add_time_option(*check, arguments->t, "Time of the motion: 0 is the source, 1 the map (default: 1)");
  check->add_flag("--untrusted", arguments->untrusted, untrusted_help);
  begin_group(*check, output_group);
  check->add_option("-o,--output", arguments->output, printed_output_help)->type_name("FILE");
  check->add_flag("--json", arguments->json, json_help);
  add_run_options(*check, arguments->run);
  check->footer(
      "Exit code 0: proved to be a bijection of space; 3: not proved.\n\n"
      "Examples:\n"
      "  bespoke check map.vdb\n"
      "  bespoke check map.vdb --t 0.5 --json");
  check->callback([arguments, handle_plan] {
    const CheckArguments given = std::exchange(*arguments, {});
    handle_plan(
        {given.run, inputs(given), outputs(given), {}, [given](const RunContext& c) { run(given, c); }});
  });
}

}  // namespace bespoke::command
