#include <algorithm>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "batch_plan.h"
#include "batch_run.h"
#include "bespoke/batch/forecast.h"
#include "bespoke/batch/job_records.h"
#include "bespoke/batch/packed_jobs.h"
#include "bespoke/error.h"
#include "commands.h"
#include "help.h"
#include "memory_option.h"
#include "standard_output.h"

namespace bespoke::command {
namespace {

struct Shard {
  std::size_t index = 1;  ///< from 1
  std::size_t count = 1;
};

struct BatchArguments {
  std::string manifest;
  std::string log;
  std::string html;
  std::string pack;
  Shard shard;
  std::optional<int> jobs;
  std::optional<int> threads;
  std::optional<std::uint64_t> max_memory;
  bool keep_going = false;
  bool dry_run = false;
  bool json = false;
  bool openjd = false;
  bool quiet = false;
};

Shard parse_shard(const std::string& text) {
  Shard shard;
  const char* end = text.data() + text.size();
  const auto [slash, bad_index] = std::from_chars(text.data(), end, shard.index);
  const bool is_split = bad_index == std::errc() && slash != end && *slash == '/';
  const auto [stop, bad_count] =
      is_split ? std::from_chars(slash + 1, end, shard.count) : std::from_chars_result{end, std::errc()};
  if (!is_split || bad_count != std::errc() || stop != end || shard.index < 1 || shard.index > shard.count)
    throw CLI::ValidationError("--shard", "'" + text + "' is not I/N with I from 1 to N, for instance 2/8");
  return shard;
}

BatchStyle style_of(const BatchArguments& arguments) {
  if (arguments.json) return BatchStyle::events;
  if (arguments.openjd) return BatchStyle::openjd;
  return arguments.quiet ? BatchStyle::quiet : BatchStyle::line;
}

BatchOptions options_of(const BatchArguments& arguments) {
  BatchOptions options = batch_options(arguments.threads.value_or(0));
  if (arguments.jobs) options.jobs = *arguments.jobs;
  if (arguments.max_memory) options.max_memory = *arguments.max_memory;
  options.keep_going = arguments.keep_going;
  return options;
}

std::string megabytes(std::size_t bytes) { return std::to_string((bytes + 999'999) / 1'000'000) + " MB"; }

std::vector<ManifestFault> too_large_jobs(const JobGraph& graph, const std::vector<JobForecast>& forecasts,
                                          std::size_t max_memory) {
  std::vector<ManifestFault> faults;
  for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
    const std::size_t needed = forecasts[i].memory + forecasts[i].shared;
    if (needed > max_memory)
      faults.push_back({graph.jobs[i].line, "needs some " + megabytes(needed) + ", but --max-memory is " +
                                                megabytes(max_memory)});
  }
  return faults;
}

/// Why each job would run, empty for those that would not: for a reason of its own or of one that it needs.
std::vector<std::string> reasons_to_run(const JobGraph& graph, PackedJobs* pack) {
  JobRecords records;
  const auto own_reason = [&](std::size_t job) {
    const BatchJob& checked = graph.jobs[job];
    return pack && is_packed(graph, job) ? pack->reason_to_run(checked) : records.reason_to_run(checked);
  };
  std::vector<std::optional<std::string>> known(graph.jobs.size());
  const std::function<const std::string&(std::size_t)> reason_of =
      [&](std::size_t job) -> const std::string& {
    if (known[job]) return *known[job];
    std::string reason;
    for (const std::size_t need : graph.needs[job])
      if (reason.empty() && !reason_of(need).empty())
        reason = "line " + std::to_string(graph.jobs[need].line) + " runs";
    return known[job].emplace(reason.empty() ? own_reason(job) : reason);
  };
  std::vector<std::string> reasons;
  for (std::size_t job = 0; job < graph.jobs.size(); ++job) reasons.push_back(reason_of(job));
  return reasons;
}

void print_plan(const JobGraph& graph, const std::vector<JobForecast>& forecasts, PackedJobs* pack) {
  const std::vector<std::string> reasons = reasons_to_run(graph, pack);
  std::size_t count = 0;
  double seconds = 0;
  for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
    if (reasons[i].empty()) continue;
    const BatchJob& job = graph.jobs[i];
    const std::string output = job.outputs.empty() ? "" : " " + job.outputs.front().path.string();
    std::printf("line %zu: %s%s: %s; about %.3g s, %s\n", job.line, job.command.c_str(), output.c_str(),
                reasons[i].c_str(), forecasts[i].seconds,
                megabytes(forecasts[i].memory + forecasts[i].shared).c_str());
    ++count;
    seconds += forecasts[i].seconds;
  }
  std::printf("%zu of %zu jobs would run, about %.3g s on one thread\n", count, graph.jobs.size(), seconds);
}

std::string log_of(const BatchArguments& arguments) { return output_target(arguments.log).string(); }

/// Nothing without --pack.
std::unique_ptr<PackedJobs> open_pack(const BatchArguments& arguments) {
  if (arguments.pack.empty()) return nullptr;
  auto pack = std::make_unique<PackedJobs>(
      arguments.pack, arguments.dry_run ? PackedJobs::Access::read : PackedJobs::Access::write);
  if (pack->torn_bytes() > 0)
    std::fprintf(stderr, "bespoke: warning: %s was not finished: %llu bytes behind its last whole job %s\n",
                 arguments.pack.c_str(), static_cast<unsigned long long>(pack->torn_bytes()),
                 arguments.dry_run ? "do not count" : "are cut off");
  return pack;
}

void run(const BatchArguments& arguments) {
  OpenedMaps maps;
  Manifest manifest = read_manifest(arguments.manifest);
  std::optional<HtmlPages> pages;
  if (!arguments.html.empty()) pages.emplace(arguments.html, fitted_maps(manifest));
  JobGraph graph = make_job_graph(plan_jobs(manifest, maps, pages ? &*pages : nullptr));
  manifest.faults.insert(manifest.faults.end(), graph.faults.begin(), graph.faults.end());
  require_no_faults(arguments.manifest, std::move(manifest.faults));
  if (graph.jobs.empty()) throw InvalidInput(arguments.manifest + ": holds no job");
  BatchOptions options = options_of(arguments);
  std::vector<JobForecast> forecasts = forecast_jobs(graph);
  require_no_faults(arguments.manifest, too_large_jobs(graph, forecasts, options.max_memory));
  if (!arguments.pack.empty()) require_no_faults(arguments.manifest, packing_faults(graph, arguments.pack));
  if (arguments.shard.count > 1) {
    const auto mine = jobs_of_shard(graph, forecasts, arguments.shard.index - 1, arguments.shard.count);
    graph = subgraph(std::move(graph), mine);
    forecasts = forecast_jobs(graph);
  }
  const std::unique_ptr<PackedJobs> pack = open_pack(arguments);
  options.pack = pack.get();
  if (arguments.dry_run)
    print_plan(graph, forecasts, pack.get());
  else
    run_jobs({arguments.manifest, style_of(arguments), log_of(arguments), pages ? &*pages : nullptr}, graph,
             forecasts, options, maps);
}

void add_limits(CLI::App& batch, BatchArguments& arguments) {
  batch
      .add_option_function<std::string>(
          "--shard", [&arguments](const std::string& text) { arguments.shard = parse_shard(text); },
          "Run the I-th of N parts of about equal cost; jobs that depend on each other stay together")
      ->type_name("I/N");
  batch.add_option("--jobs", arguments.jobs, "Jobs at a time (default: one a thread)")
      ->check(CLI::Range(1, 1024))
      ->type_name("J");
  batch.add_option("--threads", arguments.threads, "Threads of all jobs together (default: one a core)")
      ->check(CLI::Range(1, 1024))
      ->type_name("N");
  add_memory_option(batch, arguments.max_memory,
                    "What the forecasts of running jobs may add up to, for instance 16GiB (default: three "
                    "quarters of what is available)");
  batch.add_flag("--keep-going", arguments.keep_going,
                 "After a job has failed, go on with those that do not need it");
}

void add_outputs(CLI::App& batch, BatchArguments& arguments) {
  batch.add_flag("--dry-run", arguments.dry_run, "Say what would run and why, and run nothing");
  batch
      .add_option("--log", arguments.log,
                  "Append one JSON line a job: state, seconds, memory, error, figures")
      ->type_name("FILE.jsonl");
  CLI::Option* html =
      batch
          .add_option("--html", arguments.html,
                      "Write a page for every map that the batch fits, and an index of them with pictures")
          ->type_name("DIR");
  batch
      .add_option("--pack", arguments.pack,
                  "Append outputs that no other job reads to this archive, in place of files")
      ->check(CLI::Validator(
          [](const std::string& name) {
            return std::filesystem::path(name).extension() == ".tar" ? "" : name + " must end in .tar";
          },
          ""))
      ->type_name("OUT.tar")
      ->excludes(html);
  CLI::Option* json = batch.add_flag("--json", arguments.json, "Print events as JSON lines");
  batch
      .add_option_function<std::string>(
          "--progress", [&arguments](const std::string&) { arguments.openjd = true; },
          "Print the progress lines of Open Job Description")
      ->check(CLI::IsMember({"openjd"}).description(""))
      ->type_name("openjd")
      ->excludes(json);
  batch.add_flag("-q,--quiet", arguments.quiet, "No progress; failures and warnings are still printed");
}

}  // namespace

void add_batch_command(CLI::App& app) {
  auto arguments = std::make_shared<BatchArguments>();
  CLI::App* batch = app.add_subcommand("batch", "Run many jobs in parallel, and none twice");
  begin_group(*batch, input_group);
  batch
      ->add_option(
          "MANIFEST", arguments->manifest,
          "One JSON object a line, or .csv with a header: command (fit, apply, invert, compose, check, "
          "measure, diff, export, view or report), and its options by their names, positional ones in lower "
          "case")
      ->required();
  begin_group(*batch, output_group);
  add_outputs(*batch, *arguments);
  begin_group(*batch, jobs_group);
  add_limits(*batch, *arguments);
  batch->footer(
      "A job may read what another writes. A job is skipped when its outputs already belong to its inputs "
      "and "
      "options; `.bespoke-jobs.jsonl` beside its first output records this. SIGTERM stops between two "
      "jobs.\n\n"
      "With --pack, the archive has outputs under their paths from the working directory, where `tar -xf` "
      "unpacks them with their records: a batch without --pack then finds them up to date. Jobs stand in the "
      "order in which they finished; TMPDIR holds what runs. A job that is run again replaces its older "
      "outputs. "
      "One batch at a time writes an archive: with --shard, give each its own.\n\n"
      "Examples:\n"
      "  bespoke batch season.jsonl --log season.log.jsonl --keep-going\n"
      "  bespoke batch season.jsonl --shard 3/16 --threads 8 --pack season_3.tar\n"
      "  bespoke batch season.jsonl --dry-run\n\n"
      "  "
      "{\"command\":\"fit\",\"source\":\"a.obj\",\"target\":\"b.obj\",\"anchors\":\"ab.json\",\"output\":"
      "\"ab.vdb\"}\n"
      "  "
      "{\"command\":\"apply\",\"map\":\"ab.vdb\",\"product\":[\"dress.obj\",\"hat.obj\"],\"out-dir\":\"b\"}");
  batch->callback([arguments] { run(*arguments); });
}

}  // namespace bespoke::command
