#include "batch_plan.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <set>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/output_stream.h"
#include "bespoke/strings.h"
#include "commands.h"
#include "nearest_name.h"
#include "page_output.h"
#include "standard_output.h"

namespace bespoke::command {
namespace {

struct JobCommand {
  const char* name;
  void (*add)(CLI::App&, const PlanHandler&);
};

constexpr std::array commands{
    JobCommand{"fit", add_fit_command},        JobCommand{"apply", add_apply_command},
    JobCommand{"invert", add_invert_command},  JobCommand{"compose", add_compose_command},
    JobCommand{"check", add_check_command},    JobCommand{"measure", add_measure_command},
    JobCommand{"diff", add_diff_command},      JobCommand{"export", add_export_command},
    JobCommand{"view", add_view_command},      JobCommand{"report", add_report_command},
    JobCommand{"flatten", add_flatten_command}};

// What the batch decides for all of its jobs.
constexpr std::array keys_of_the_batch{"threads", "quiet", "verbose", "help", "html"};

std::vector<std::string> names_of_commands() {
  std::vector<std::string> names;
  for (const JobCommand& command : commands) names.emplace_back(command.name);
  return names;
}

std::string upper_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::vector<std::string> keys_of(const CLI::App& command) {
  std::vector<std::string> keys;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) keys.push_back(name);
  for (const CLI::Option* option : command.get_options())
    if (option->get_positional()) keys.push_back(lower_case(option->get_name(true)));
  return keys;
}

/// The option that a key names: `--key`, or the positional KEY.
const CLI::Option& option_of(const CLI::App& command, const std::string& key) {
  if (std::find(keys_of_the_batch.begin(), keys_of_the_batch.end(), key) != keys_of_the_batch.end())
    throw InvalidInput("\"" + key + "\" is for the whole batch, not for a job");
  const CLI::Option* option = command.get_option_no_throw("--" + key);
  const bool is_key = key == lower_case(key) && !key.empty();
  if (!option && is_key) option = command.get_option_no_throw(upper_case(key));
  if (!option)
    throw InvalidInput("unknown key \"" + key + "\"" + suggestion(key, keys_of(command)) + "; `bespoke " +
                       command.get_name() + " --help` lists the options");
  return *option;
}

void add_option_text(const ManifestEntry& entry, const CLI::Option& option,
                     std::vector<std::string>& arguments) {
  const bool is_flag = option.get_items_expected_max() == 0;
  if (entry.flag && !is_flag) throw InvalidInput("\"" + entry.key + "\" needs a value");
  if (!entry.flag && is_flag) throw InvalidInput("\"" + entry.key + "\" is either true or false");
  for (const std::string& value : entry.values)
    arguments.push_back("--" + entry.key + (is_flag ? "" : "=" + value));
}

/// Whether a job names a catalogue instead of a map.
bool finds_map(const ManifestJob& line) {
  return std::any_of(line.entries.begin(), line.entries.end(),
                     [](const ManifestEntry& entry) { return entry.key == "from"; });
}

/// As the command line would give them. Positional ones come last, where nothing can be taken for an option.
std::vector<std::string> arguments_of(const ManifestJob& line, const CLI::App& command) {
  std::vector<std::string> arguments{line.command, "--quiet"};
  std::map<std::string, std::vector<std::string>> positional;
  for (const ManifestEntry& entry : line.entries) {
    const CLI::Option& option = option_of(command, entry.key);
    if (!option.get_positional())
      add_option_text(entry, option, arguments);
    else if (entry.flag)
      throw InvalidInput("\"" + entry.key + "\" needs a value");
    else
      positional[upper_case(entry.key)] = entry.values;
  }
  arguments.emplace_back("--");
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional()) continue;
    const std::string name = option->get_name(true);
    const auto values = positional.find(name);
    if (values == positional.end() && name == "MAP" && finds_map(line)) continue;
    if (values == positional.end()) throw InvalidInput("\"" + lower_case(name) + "\" is missing");
    if (option->get_items_expected_max() == 1 && values->second.size() > 1)
      throw InvalidInput("\"" + lower_case(name) + "\" takes one value");
    arguments.insert(arguments.end(), values->second.begin(), values->second.end());
  }
  return arguments;
}

/// A batch keeps records of files, which a stream is not.
void require_files(const std::vector<JobFile>& outputs) {
  for (const JobFile& output : outputs)
    if (is_standard_output(output.path) || is_stream(output.path))
      throw InvalidInput(output.role + " " + output.path.string() +
                         " is no file; a job of a batch writes files only");
}

std::string joined(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) text += (text.empty() ? "" : ",") + value;
  return text;
}

}  // namespace

struct JobPlanner::Parser {
  CLI::App app;
  CLI::App* command = nullptr;
};

JobPlanner::Parser& JobPlanner::parser_of(const std::string& command) {
  std::shared_ptr<Parser>& parser = parsers_[command];
  if (parser) return *parser;
  const auto known = std::find_if(commands.begin(), commands.end(),
                                  [&](const JobCommand& row) { return row.name == command; });
  if (known == commands.end())
    throw InvalidInput("unknown command \"" + command + "\"" + suggestion(command, names_of_commands()) +
                       "; a job is " + alternatives(names_of_commands()));
  parser = std::make_shared<Parser>();
  known->add(parser->app, [this](PlannedRun planned) { planned_ = std::move(planned); });
  parser->command = parser->app.get_subcommand(command);
  return *parser;
}

BatchJob JobPlanner::plan(const ManifestJob& line) {
  Parser& parser = parser_of(line.command);
  std::vector<std::string> arguments = arguments_of(line, *parser.command);
  const std::string command = command_text(arguments);
  std::reverse(arguments.begin(), arguments.end());  // as the parser wants them
  try {
    parser.app.parse(arguments);
  } catch (...) {
    parsers_.erase(line.command);  // it may hold half of the line
    throw;
  }
  return job_of(line, std::exchange(planned_, {}), command);
}

BatchJob JobPlanner::job_of(const ManifestJob& line, PlannedRun planned, const std::string& command) const {
  require_files(planned.outputs);
  BatchJob job;
  job.line = line.line;
  job.command = line.command;
  job.inputs = std::move(planned.inputs);
  job.outputs = std::move(planned.outputs);
  job.shared_map = std::move(planned.shared_map);
  std::set<std::string> roles;
  for (const JobFile& file : job.inputs) roles.insert(file.role);
  for (const JobFile& file : job.outputs) roles.insert(file.role);
  for (const ManifestEntry& entry : line.entries)
    if (!roles.contains(entry.key) && !entry.values.empty())
      job.options.emplace_back(entry.key, joined(entry.values));
  std::sort(job.options.begin(), job.options.end());
  job.run = [run = std::move(planned.run), &maps = maps_, command](const Progress& progress) {
    JobFindings findings;
    run({progress, maps, findings, [&](const std::string& warning) { findings.warnings.push_back(warning); },
         [](const std::string&) {}, command, true});
    return findings;
  };
  return job;
}

std::vector<BatchJob> plan_jobs(Manifest& manifest, OpenedMaps& maps, const HtmlPages* pages) {
  JobPlanner planner(maps);
  std::vector<BatchJob> jobs;
  std::vector<ManifestJob> lines = manifest.jobs;
  if (pages)
    for (ManifestJob& line : pages->page_lines()) lines.push_back(std::move(line));
  for (const ManifestJob& line : lines) {
    try {
      jobs.push_back(planner.plan(line));
    } catch (const std::exception& error) {
      manifest.faults.push_back({line.line, error.what()});
    }
  }
  if (pages)
    for (BatchJob& job : pages->picture_jobs(maps)) jobs.push_back(std::move(job));
  return jobs;
}

}  // namespace bespoke::command
