#include "bespoke/batch/job_record.h"

#include <utility>

#include "bespoke/pipeline/summary_json.h"

namespace bespoke {
namespace {

// Goes up when the same inputs and options give other bytes, or the record says other things.
constexpr int record_version = 29;

Json files_json(const std::vector<RecordedFile>& files) {
  Json json = Json::array();
  for (const RecordedFile& file : files)
    json.push_back({{"role", file.role},
                    {"file", file.file},
                    {"sha256", file.content.hash},
                    {"bytes", file.content.stamp.bytes},
                    {"modified", file.content.stamp.modified}});
  return json;
}

std::vector<RecordedFile> parse_files(const Json& json) {
  std::vector<RecordedFile> files;
  for (const Json& file : json)
    files.push_back({file.at("role"),
                     file.at("file"),
                     {{file.at("bytes"), file.at("modified")}, false, file.at("sha256")}});
  return files;
}

std::map<std::string, std::string> options_of(const BatchJob& job) {
  return {job.options.begin(), job.options.end()};
}

}  // namespace

std::filesystem::path record_directory(const BatchJob& job) { return job.outputs.front().path.parent_path(); }

std::string output_name(const BatchJob& job) { return job.outputs.front().path.filename().string(); }

std::string named(const JobFile& file) { return file.role + " " + file.path.string(); }

std::string to_line(const JobRecord& record) {
  Json options = Json::object();
  for (const auto& [name, value] : record.options) options[name] = value;
  return Json{{"output", record.output},
              {"version", record.version},
              {"command", record.command},
              {"options", std::move(options)},
              {"inputs", files_json(record.inputs)},
              {"outputs", files_json(record.outputs)}}
      .dump();
}

std::optional<JobRecord> parse_job_record(const std::string& line) {
  try {
    const Json json = Json::parse(line);
    JobRecord record{json.at("output"), json.at("version"), json.at("command"), {}, {}, {}};
    for (const auto& [name, value] : json.at("options").items()) record.options[name] = value;
    record.inputs = parse_files(json.at("inputs"));
    record.outputs = parse_files(json.at("outputs"));
    return record;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

JobRecord record_of(const BatchJob& job, std::vector<RecordedFile> inputs) {
  return {output_name(job), record_version, job.command, options_of(job), std::move(inputs), {}};
}

RecordedFile recorded(const JobFile& file, const std::filesystem::path& directory, FileHashes& hashes) {
  return {file.role, file.path.lexically_proximate(directory).string(), hashes.of(file.path)};
}

std::vector<RecordedFile> recorded_inputs(const BatchJob& job, FileHashes& hashes) {
  std::vector<RecordedFile> inputs;
  for (const JobFile& input : job.inputs) {
    inputs.push_back(recorded(input, record_directory(job), hashes));
    FileHashes::HashedFile& content = inputs.back().content;
    if (content.was_recent) content.stamp.modified = 0;
  }
  return inputs;
}

bool is_the_same(const RecordedFile& recorded, const std::filesystem::path& path, FileHashes& hashes) {
  const std::optional<FileStamp> stamp = stamp_of(path);
  return stamp && (recorded.content.stamp == *stamp || recorded.content.hash == hashes.of(path).hash);
}

std::string changed_since(const JobRecord& record, const BatchJob& job, FileHashes& hashes) {
  if (record.version != record_version) return "it was made by another version";
  if (record.command != job.command || record.options != options_of(job)) return "its options have changed";
  if (record.inputs.size() != job.inputs.size()) return "it has other inputs";
  for (std::size_t i = 0; i < job.inputs.size(); ++i) {
    if (record.inputs[i].role != job.inputs[i].role) return "it has other inputs";
    if (!is_the_same(record.inputs[i], job.inputs[i].path, hashes))
      return named(job.inputs[i]) + " has changed";
  }
  return {};
}

}  // namespace bespoke
