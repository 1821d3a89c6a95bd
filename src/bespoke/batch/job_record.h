#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/file_hashes.h"

namespace bespoke {

/// A file of a job as its record has it.
struct RecordedFile {
  std::string role;
  std::string file;  ///< as seen from the record's directory, so that this may be moved or copied
  FileHashes::HashedFile content;
};

/// What a finished job was made of.
struct JobRecord {
  std::string output;  ///< the name of the first
  int version = 0;
  std::string command;
  std::map<std::string, std::string> options;
  std::vector<RecordedFile> inputs;
  std::vector<RecordedFile> outputs;
};

/// Of a job that writes something: where its first output lies, and its record as seen from there.
std::filesystem::path record_directory(const BatchJob& job);

/// The name of its first output in that directory.
std::string output_name(const BatchJob& job);

/// One JSON line, without its end.
std::string to_line(const JobRecord& record);

/// Nothing where the line is damaged.
std::optional<JobRecord> parse_job_record(const std::string& line);

/// The record of a job, without outputs.
JobRecord record_of(const BatchJob& job, std::vector<RecordedFile> inputs);

/// The file as it is. Throws FileError.
RecordedFile recorded(const JobFile& file, const std::filesystem::path& directory, FileHashes& hashes);

/// What the job is about to read: a file that changes while the job runs makes it run again. Throws
/// FileError.
std::vector<RecordedFile> recorded_inputs(const BatchJob& job, FileHashes& hashes);

/// Whether the file is as the record has it. One whose size and time of change are those of the record is not
/// read. Throws FileError.
bool is_the_same(const RecordedFile& recorded, const std::filesystem::path& path, FileHashes& hashes);

/// Why the job must run by what its record says of its version, command, options and inputs; empty where
/// these are the same. Throws FileError when an input cannot be read.
std::string changed_since(const JobRecord& record, const BatchJob& job, FileHashes& hashes);

/// "output a.obj".
std::string named(const JobFile& file);

}  // namespace bespoke
