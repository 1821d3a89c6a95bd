#include "planned_run.h"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "output_files.h"
#include "page_output.h"

namespace bespoke::command {
namespace {

std::vector<std::filesystem::path> paths(const std::vector<JobFile>& files) {
  std::vector<std::filesystem::path> all;
  for (const JobFile& file : files) all.push_back(file.path);
  return all;
}

}  // namespace

void run_at_once(PlannedRun planned) {
  run_with(planned.options, [&](const Progress& progress) {
    OpenedMaps maps;
    JobFindings findings;
    planned.run(
        {progress, maps, findings,
         [](const std::string& warning) { std::fprintf(stderr, "bespoke: warning: %s\n", warning.c_str()); },
         [](const std::string& text) { std::fputs(text.c_str(), stdout); }, typed_command()});
  });
}

std::vector<JobFile> named_files(std::vector<JobFile> files) {
  std::erase_if(files, [](const JobFile& file) { return file.path.empty(); });
  return files;
}

void require_safe_outputs(const std::vector<JobFile>& inputs, const std::vector<JobFile>& outputs) {
  require_safe_outputs(paths(inputs), paths(outputs));
}

void write_result(const std::string& output, const std::string& text, const RunContext& context) {
  if (output.empty()) return context.print(text);
  OutputFiles files;
  files.write_text(output, text);
  files.keep();
}

}  // namespace bespoke::command
