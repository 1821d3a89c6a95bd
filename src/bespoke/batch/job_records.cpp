#include "bespoke/batch/job_records.h"

#include <algorithm>
#include <fstream>
#include <optional>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

/// The last whole line of every output.
std::unordered_map<std::string, std::string> last_lines(const fs::path& path) {
  std::unordered_map<std::string, std::string> last;
  std::ifstream file(path, std::ios::binary);
  for (std::string line; std::getline(file, line);)
    if (const std::optional<JobRecord> record = parse_job_record(line)) last[record->output] = line;
  return last;
}

std::vector<fs::path> unpacked_files(const fs::path& directory) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(unpacked_records(directory), none))
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::string changed_output(const JobRecord& record, const BatchJob& job, FileHashes& hashes) {
  const fs::path directory = record_directory(job);
  if (record.outputs.size() < job.outputs.size()) return "it has other outputs";
  for (std::size_t i = 0; i < record.outputs.size(); ++i) {
    const fs::path path = directory / record.outputs[i].file;
    const bool is_named = i < job.outputs.size();
    if (is_named && path.lexically_normal() != job.outputs[i].path.lexically_normal())
      return "it has other outputs";
    if (!is_the_same(record.outputs[i], path, hashes))
      return "output " + path.string() + (stamp_of(path) ? " has changed" : " is missing");
  }
  return {};
}

}  // namespace

fs::path record_path(const BatchJob& job) { return record_directory(job) / ".bespoke-jobs.jsonl"; }

fs::path unpacked_records(const fs::path& directory) { return directory / ".bespoke-jobs"; }

std::vector<std::string> JobRecords::lines_of(const BatchJob& job) {
  const fs::path path = record_path(job);
  const std::lock_guard lock(mutex_);
  const auto [lines, is_new] = lines_.try_emplace(path.native());
  if (is_new) {
    std::vector<fs::path> files = unpacked_files(record_directory(job));
    files.insert(files.begin(), path);
    for (const fs::path& file : files)
      for (auto& [output, line] : last_lines(file)) lines->second[output].push_back(std::move(line));
  }
  const auto known = lines->second.find(output_name(job));
  return known == lines->second.end() ? std::vector<std::string>() : known->second;
}

std::string JobRecords::reason_to_run(const BatchJob& job) {
  if (job.outputs.empty()) return "it writes no file";
  for (const JobFile& output : job.outputs)
    if (!stamp_of(output.path)) return named(output) + " is missing";
  std::string first_reason;
  for (const std::string& line : lines_of(job)) {
    const std::optional<JobRecord> record = parse_job_record(line);
    if (!record) continue;
    std::string reason = changed_since(*record, job, hashes_);
    if (reason.empty()) reason = changed_output(*record, job, hashes_);
    if (reason.empty()) return {};
    if (first_reason.empty()) first_reason = std::move(reason);
  }
  return first_reason.empty() ? "there is no record of it" : first_reason;
}

std::vector<RecordedFile> JobRecords::inputs_of(const BatchJob& job) {
  return job.outputs.empty() ? std::vector<RecordedFile>() : recorded_inputs(job, hashes_);
}

void JobRecords::write(const BatchJob& job, const std::vector<RecordedFile>& inputs,
                       const JobFindings& findings) {
  if (job.outputs.empty()) return;
  const fs::path path = record_path(job), directory = record_directory(job);
  JobRecord record = record_of(job, inputs);
  for (const JobFile& output : job.outputs) record.outputs.push_back(recorded(output, directory, hashes_));
  for (const fs::path& output : findings.further_outputs)
    record.outputs.push_back(recorded({"further", output}, directory, hashes_));
  std::string line = to_line(record);
  const std::lock_guard lock(mutex_);
  std::unique_ptr<LineLog>& log = logs_[path.native()];
  if (!log) log = std::make_unique<LineLog>(path);
  log->append(line);
  lines_[path.native()][output_name(job)] = {std::move(line)};
}

}  // namespace bespoke
