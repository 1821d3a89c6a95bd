#pragma once

#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/file_hashes.h"
#include "bespoke/batch/job_record.h"
#include "bespoke/batch/line_log.h"

namespace bespoke {

/// The file beside the first output of a job that says what it was made of, one JSON line a job of its
/// directory, the last line of an output being true. Several processes may append. It is not flushed to the
/// disk, and a line that is lost or damaged costs a run of its job, no more.
std::filesystem::path record_path(const BatchJob& job);

/// Further files of such lines lie here, where an archive of `PackedJobs` was unpacked into the directory of
/// outputs. A job is up to date when one of its lines says so, whichever.
std::filesystem::path unpacked_records(const std::filesystem::path& directory);

/// What finished jobs were made of. Thread-safe.
class JobRecords {
 public:
  /// Why a job must run, for instance "source body.obj has changed"; empty when it need not: its record is
  /// of the same command, options, version and input contents, and its outputs are there as they were
  /// written. A file whose size and time of change are those of the record is not read. A job without outputs
  /// always runs. Throws FileError when a file cannot be read.
  std::string reason_to_run(const BatchJob& job);

  /// What the job is about to read: a file that changes while the job runs makes it run again. Throws
  /// FileError.
  std::vector<RecordedFile> inputs_of(const BatchJob& job);

  /// Once all outputs are written. Throws FileError.
  void write(const BatchJob& job, const std::vector<RecordedFile>& inputs, const JobFindings& findings);

 private:
  using Lines = std::unordered_map<std::string, std::vector<std::string>>;  // by output

  std::vector<std::string> lines_of(const BatchJob& job);

  FileHashes hashes_;
  std::mutex mutex_;                                                // of all below
  std::unordered_map<std::string, Lines> lines_;                    // by the record's path
  std::unordered_map<std::string, std::unique_ptr<LineLog>> logs_;  // likewise
};

}  // namespace bespoke
