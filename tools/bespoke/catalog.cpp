#include "bespoke/catalog/catalog.h"

#include <cstdio>
#include <memory>

#include "bespoke/catalog/catalog_file.h"
#include "bespoke/error.h"
#include "commands.h"
#include "help.h"
#include "output_files.h"

namespace bespoke::command {
namespace {

namespace fs = std::filesystem;

struct CatalogArguments {
  std::string directory;
  bool untrusted = false;
  RunOptions run;
};

void run(const CatalogArguments& arguments, const Progress& progress) {
  const fs::path directory = arguments.directory;
  const Catalog catalog = index_assets(directory, {.untrusted = arguments.untrusted}, progress);
  OutputFiles files;
  const fs::path json = catalog_path(directory), page = directory / "catalog.html";
  files.write_text(json, catalog_json(catalog));
  files.write_text(page, catalog_page(catalog));
  files.keep();
  for (const RefusedFile& refused : catalog.refused)
    std::fprintf(stderr, "bespoke: %s: %s\n", (directory / refused.file).c_str(), refused.reason.c_str());
  if (!arguments.run.quiet) {
    std::printf("%zu maps in %s and %s\n", catalog.assets.size(), json.c_str(), page.c_str());
    if (!catalog.others.empty())
      std::printf("%zu other volumes, which are no maps, are not listed\n", catalog.others.size());
  }
  if (!catalog.refused.empty())
    throw FormatError(std::to_string(catalog.refused.size()) + " of " +
                      std::to_string(catalog.refused.size() + catalog.assets.size()) +
                      " files are no valid maps; the others are in the catalogue");
}

}  // namespace

void add_catalog_command(CLI::App& app) {
  auto arguments = std::make_shared<CatalogArguments>();
  CLI::App* catalog = app.add_subcommand(
      "catalog", "Verify the maps in a directory, and list them in catalog.json and catalog.html");
  begin_group(*catalog, input_group);
  catalog->add_option("DIR", arguments->directory, "Directory with .vdb files, in it and below")->required();
  catalog->add_flag("--untrusted", arguments->untrusted,
                    "Check each file in a child process under limits first");
  add_run_options(*catalog, arguments->run);
  catalog->footer(
      "The catalogue is made of the files alone, each time. `bespoke apply --from DIR` finds maps in it.\n"
      "Exit code 2: some files are no valid maps; they are named, here and in the catalogue.\n\n"
      "Examples:\n"
      "  bespoke catalog season\n"
      "  bespoke apply dress.obj --from season --source woman.obj --target anna.obj -o dress_on_anna.obj");
  catalog->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
