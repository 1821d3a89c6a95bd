#include "bespoke/batch/job_records.h"

#include <fstream>
#include <optional>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

// Goes up when the same inputs and options give other bytes, or the record says other things.
constexpr int record_version = 1;

Json options_json(const BatchJob& job) {
  Json options = Json::object();
  for (const auto& [name, value] : job.options) options[name] = value;
  return options;
}

Json to_json(const std::vector<RecordedFile>& files) {
  Json json = Json::array();
  for (const RecordedFile& file : files)
    json.push_back({{"role", file.role},
                    {"file", file.file},
                    {"sha256", file.content.hash},
                    {"bytes", file.content.stamp.bytes},
                    {"modified", file.content.stamp.modified}});
  return json;
}

bool has_stamp(const Json& json, const FileStamp& stamp) {
  return json.value("bytes", std::uint64_t{0}) == stamp.bytes &&
         json.value("modified", std::int64_t{0}) == stamp.modified;
}

bool is_the_same(const Json& json, const fs::path& path, FileHashes& hashes) {
  const std::optional<FileStamp> stamp = stamp_of(path);
  return stamp && (has_stamp(json, *stamp) || json.value("sha256", "") == hashes.of(path).hash);
}

/// The record; nothing where it is damaged.
Json parse_record(const std::string& line) {
  Json record = Json::parse(line, nullptr, /*allow_exceptions=*/false);
  const bool complete = record.is_object() && record.contains("options") && record.contains("inputs") &&
                        record["inputs"].is_array() && record.contains("outputs") &&
                        record["outputs"].is_array() && record.contains("output") &&
                        record["output"].is_string();
  return complete ? record : Json();
}

std::string output_name(const BatchJob& job) { return job.outputs.front().path.filename().string(); }

std::string named(const JobFile& file) { return file.role + " " + file.path.string(); }

std::string changed_input(const BatchJob& job, const Json& inputs, FileHashes& hashes) {
  if (inputs.size() != job.inputs.size()) return "it has other inputs";
  for (std::size_t i = 0; i < job.inputs.size(); ++i) {
    if (inputs[i].value("role", "") != job.inputs[i].role) return "it has other inputs";
    if (!is_the_same(inputs[i], job.inputs[i].path, hashes)) return named(job.inputs[i]) + " has changed";
  }
  return {};
}

std::string changed_output(const BatchJob& job, const Json& outputs, FileHashes& hashes) {
  const fs::path directory = record_path(job).parent_path();
  if (outputs.size() < job.outputs.size()) return "it has other outputs";
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const fs::path path = directory / outputs[i].value("file", "");
    const bool is_named = i < job.outputs.size();
    if (is_named && path.lexically_normal() != job.outputs[i].path.lexically_normal())
      return "it has other outputs";
    if (!is_the_same(outputs[i], path, hashes))
      return "output " + path.string() + (stamp_of(path) ? " has changed" : " is missing");
  }
  return {};
}

}  // namespace

fs::path record_path(const BatchJob& job) {
  return job.outputs.front().path.parent_path() / ".bespoke-jobs.jsonl";
}

std::string JobRecords::line_of(const BatchJob& job) {
  const fs::path path = record_path(job);
  const std::lock_guard lock(mutex_);
  const auto [lines, is_new] = lines_.try_emplace(path.native());
  if (is_new) {
    std::ifstream file(path, std::ios::binary);
    for (std::string line; std::getline(file, line);) {
      const Json record = parse_record(line);
      if (!record.is_null()) lines->second[record["output"].get<std::string>()] = line;
    }
  }
  const auto line = lines->second.find(output_name(job));
  return line == lines->second.end() ? std::string() : line->second;
}

std::string JobRecords::reason_to_run(const BatchJob& job) {
  if (job.outputs.empty()) return "it writes no file";
  for (const JobFile& output : job.outputs)
    if (!stamp_of(output.path)) return named(output) + " is missing";
  const Json record = parse_record(line_of(job));
  if (record.is_null()) return "there is no record of it";
  if (record.value("version", 0) != record_version) return "it was made by another version";
  if (record.value("command", "") != job.command || record["options"] != options_json(job))
    return "its options have changed";
  const std::string input = changed_input(job, record["inputs"], hashes_);
  return input.empty() ? changed_output(job, record["outputs"], hashes_) : input;
}

RecordedFile JobRecords::recorded(const JobFile& file, const fs::path& directory) {
  return {file.role, file.path.lexically_proximate(directory).string(), hashes_.of(file.path)};
}

std::vector<RecordedFile> JobRecords::inputs_of(const BatchJob& job) {
  std::vector<RecordedFile> inputs;
  if (job.outputs.empty()) return inputs;
  const fs::path directory = record_path(job).parent_path();
  for (const JobFile& input : job.inputs) {
    inputs.push_back(recorded(input, directory));
    FileHashes::HashedFile& content = inputs.back().content;
    if (content.was_fresh) content.stamp.modified = 0;
  }
  return inputs;
}

void JobRecords::write(const BatchJob& job, const std::vector<RecordedFile>& inputs,
                       const JobFindings& findings) {
  if (job.outputs.empty()) return;
  const fs::path path = record_path(job), directory = path.parent_path();
  std::vector<RecordedFile> outputs;
  for (const JobFile& output : job.outputs) outputs.push_back(recorded(output, directory));
  for (const fs::path& output : findings.further_outputs)
    outputs.push_back(recorded({"further", output}, directory));
  const Json record = {{"output", output_name(job)}, {"version", record_version},
                       {"command", job.command},     {"options", options_json(job)},
                       {"inputs", to_json(inputs)},  {"outputs", to_json(outputs)}};
  std::string line = record.dump();
  const std::lock_guard lock(mutex_);
  std::unique_ptr<LineLog>& log = logs_[path.native()];
  if (!log) log = std::make_unique<LineLog>(path);
  log->append(line);
  lines_[path.native()][output_name(job)] = std::move(line);
}

}  // namespace bespoke
