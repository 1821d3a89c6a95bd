#include "samples.h"

#include <cstdio>
#include <filesystem>
#include <memory>

#include "commands.h"
#include "help.h"
#include "run_options.h"

namespace bespoke::command {
namespace {

struct SamplesArguments {
  std::string directory;
  std::vector<std::string> names;
  RunOptions run;
};

void run(const SamplesArguments& arguments, const Progress& progress) {
  const std::vector<std::string> names = arguments.names.empty() ? sample_names() : arguments.names;
  for (std::size_t i = 0; i < names.size(); ++i) {
    progress.step("samples", i, names.size());
    for (const std::filesystem::path& path : write_sample(make_sample(names[i]), arguments.directory))
      if (!arguments.run.quiet) std::printf("%s\n", path.c_str());
  }
  progress.step("samples", names.size(), names.size());
}

}  // namespace

void add_samples_command(CLI::App& app) {
  auto arguments = std::make_shared<SamplesArguments>();
  CLI::App* samples =
      app.add_subcommand("samples", "Write example pairs of models, with anchors and products");
  begin_group(*samples, output_group);
  samples->add_option("DIR", arguments->directory, "Directory to write to; it is made if it does not exist")
      ->required();
  std::string known;
  for (const std::string& name : sample_names()) known += (known.empty() ? "" : ", ") + name;
  samples->add_option("NAME", arguments->names, "Which of " + known + " (default: all)")
      ->check(CLI::IsMember(sample_names()));
  add_run_options(*samples, arguments->run);
  samples->footer(
      "Each NAME becomes a directory with source.obj, one target or several (cm), their anchors and the "
      "products.\n\n"
      "Examples:\n"
      "  bespoke samples build/samples\n"
      "  bespoke samples build/samples dress glove");
  samples->callback([arguments] {
    run_with(arguments->run, [&](const Progress& progress) { run(*arguments, progress); });
  });
}

}  // namespace bespoke::command
