#include <CLI/CLI.hpp>
#include <iostream>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "exit_code.h"
#include "help.h"
#include "interruption.h"
#include "nearest_name.h"
#include "page_output.h"
#include "versions.h"

namespace {

/// The subcommand, as far as it was recognised.
const CLI::App& chosen_command(const CLI::App& app) {
  const CLI::App* chosen = &app;
  while (!chosen->get_subcommands().empty()) chosen = chosen->get_subcommands().front();
  return *chosen;
}

/// The command that explains the subcommand.
std::string help_command(const CLI::App& app) {
  std::string command = app.get_name();
  for (const CLI::App* chosen = &app; !chosen->get_subcommands().empty();) {
    chosen = chosen->get_subcommands().front();
    command += ' ' + chosen->get_name();
  }
  return command + " --help";
}

bool wants_versions(int argc, char** argv) {
  const std::set<std::string> given(argv + 1, argv + argc);
  return given == std::set<std::string>{"--json", "--version"};
}

/// In the order of the help.
void add_commands(CLI::App& app) {
  using namespace bespoke::command;
  const auto group = [&](const char* title, const std::vector<std::string>& names) {
    for (const std::string& name : names) app.get_subcommand(name)->group(title);
  };
  add_fit_command(app, run_at_once);
  add_pick_command(app);
  add_anchors_command(app);
  add_invert_command(app, run_at_once);
  add_compose_command(app, run_at_once);
  add_samples_command(app);
  group("Make a map", {"fit", "pick", "anchors", "invert", "compose", "samples"});
  add_apply_command(app, run_at_once);
  add_flatten_command(app, run_at_once);
  group("Use it", {"apply", "flatten"});
  add_view_command(app, run_at_once);
  add_report_command(app, run_at_once);
  add_info_command(app);
  add_check_command(app, run_at_once);
  add_measure_command(app, run_at_once);
  add_diff_command(app, run_at_once);
  group("Look at it", {"view", "report", "info", "check", "measure", "diff"});
  add_batch_command(app);
  add_grade_command(app);
  add_catalog_command(app);
  group("Many maps and products", {"batch", "grade", "catalog"});
  add_export_command(app, run_at_once);
  group("Exchange with other programs", {"export"});
}

}  // namespace

int main(int argc, char** argv) {
  using namespace bespoke::command;
  if (wants_versions(argc, argv)) {
    std::cout << versions_json() << '\n';
    return 0;
  }
  CLI::App app{
      "Registers one model to another, extends that to a map of the space around them, and carries products "
      "across."};
  app.name("bespoke");
  app.set_version_flag("--version", BESPOKE_VERSION,
                       "Print the version; with --json those of the libraries inside as well");
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 wrong arguments, 2 bad input, 3 the fit did not succeed, 4 file or memory "
      "trouble, "
      "130 or 143 interrupted.\n\n"
      "`bespoke COMMAND --help` explains a command with examples; `bespoke fit -h` has the options that "
      "people "
      "set.");
  set_grouped_help(app);
  add_commands(app);

  remember_arguments(argc, argv);
  remember_interruptions();
  return exit_code_of([&] {
    try {
      require_known_subcommands(app, {argv + 1, argv + argc});
      app.parse(argc, argv);
    } catch (const CLI::Success& request) {
      app.exit(request);  // --help and --version print and are done
    } catch (const CLI::ParseError& error) {
      throw CLI::ParseError(explanation(chosen_command(app), error) + "; see " + help_command(app),
                            CLI::ExitCodes(error.get_exit_code()));
    }
  });
}
