#include <iostream>
#include <memory>

#include "bespoke/asset/asset_io.h"
#include "bespoke/error.h"
#include "bespoke/pipeline/certify_map.h"
#include "bespoke/pipeline/summary_json.h"
#include "commands.h"
#include "run_options.h"
#include "time_option.h"

namespace bespoke::command {
namespace {

struct CheckArguments {
  std::string map;
  double t = 1;
  bool json = false;
  bool untrusted = false;
  RunOptions run;
};

constexpr std::size_t printed_places = 10;

void print_places(const Certificate& certificate) {
  const std::size_t count = std::min(printed_places, certificate.places.size());
  for (std::size_t i = 0; i < count; ++i)
    std::cout << "  level " << certificate.places[i].level << " at "
              << certificate.places[i].center.transpose() << ": det " << certificate.places[i].determinant
              << '\n';
  if (certificate.places.size() > count)
    std::cout << "  and " << certificate.folded + certificate.undecided - count << " more\n";
}

void run(const CheckArguments& arguments, const Progress& progress) {
  const Asset asset = read_asset(arguments.map, {.untrusted = arguments.untrusted});
  const Certificate certificate = certify_map(asset, arguments.t, progress);
  if (arguments.json) {
    std::cout << to_json(certificate).dump(2) << '\n';
  } else {
    std::cout << to_string(certificate) << '\n';
    print_places(certificate);
  }
  if (!certificate.is_bijection())
    throw SolverError(arguments.map + ": not proved to be a bijection at t = " + std::to_string(arguments.t));
}

}  // namespace

void add_check_command(CLI::App& app) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* check =
      app.add_subcommand("check", "Prove from the file alone that a map does not fold, or say where it does");
  check->add_option("MAP", arguments->map, "Asset, .vdb")->required();
  add_time_option(*check, arguments->t, "Time of the motion, 0 = identity, 1 = the map (default: 1)");
  check->add_flag("--json", arguments->json, "Print one JSON object instead of lines");
  check->add_flag("--untrusted", arguments->untrusted,
                  "Check the file in a child process under limits first");
  add_run_options(*check, arguments->run);
  check->footer(
      "Exit code 0: proved to be a bijection of space; 3: not proved.\n\n"
      "Examples:\n"
      "  bespoke check map.vdb\n"
      "  bespoke check map.vdb --t 0.5 --json");
  check->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
