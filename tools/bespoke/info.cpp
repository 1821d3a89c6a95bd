#include <iostream>
#include <memory>

#include "bespoke/asset/asset_io.h"
#include "bespoke/error.h"
#include "bespoke/report/inspection.h"
#include "commands.h"
#include "help.h"

namespace bespoke::command {
namespace {

struct InfoArguments {
  std::string map;
  bool json = false;
  bool untrusted = false;
};

void require_same(const Certificate& stored, const Certificate& found, const std::string& map) {
  if (stored.certified == found.certified && stored.folded == found.folded &&
      stored.undecided == found.undecided)
    return;
  throw FormatError(map + ": its certificate is not that of its map, which has: " + to_string(found));
}

void run(const InfoArguments& arguments) {
  const Asset asset = read_asset(arguments.map, {.untrusted = arguments.untrusted});
  // What a file states is worth what its author is.
  if (arguments.untrusted)
    for (const MapStep& step : asset.steps)
      require_same(step.certificate, certify(step.pyramid, step.affine), arguments.map);
  std::cout << (arguments.json ? inspection_json(asset) : inspection_text(asset));
}

}  // namespace

void add_info_command(CLI::App& app) {
  auto arguments = std::make_shared<InfoArguments>();
  CLI::App* info = app.add_subcommand("info", "Say what a map holds and what is proved about it");
  begin_group(*info, input_group);
  info->add_option("MAP", arguments->map, map_help)->required();
  info->add_flag("--untrusted", arguments->untrusted,
                 "Check the file in a child process under limits first, and its certificate against its map");
  begin_group(*info, output_group);
  info->add_flag("--json", arguments->json, json_help);
  info->footer(
      "Examples:\n"
      "  bespoke info map.vdb\n"
      "  bespoke info map.vdb --json | jq .certificate");
  info->callback([arguments] { run(*arguments); });
}

}  // namespace bespoke::command
