#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include "bespoke/atomic_file.h"
#include "bespoke/batch/file_hashes.h"
#include "bespoke/batch/job_graph.h"
#include "bespoke/batch/job_record.h"

namespace bespoke {

class RandomAccessFile;

/// Whether the job's outputs go into the archive where there is one: no other job reads any of them.
bool is_packed(const JobGraph& graph, std::size_t job);

/// What keeps the jobs of a manifest out of this archive, with the lines: an output that lies outside the
/// working directory, for its path from there is its name; a job that reads or writes the archive itself.
std::vector<ManifestFault> packing_faults(const JobGraph& graph, const std::filesystem::path& archive);

/// Outputs of finished jobs and the records of what these were made of, in one tar file:
///     mark │ record │ output │ output │ record │ output │ … │ files of records │ end
/// Other programs take mark and records for comments. Each job is appended as a whole; the next writer cuts
/// off what a killed one left torn and, in an archive without its end, drops outputs that do not match their
/// records. The later of two outputs of one name counts, as for `tar -x`. Thread-safe.
class PackedJobs {
 public:
  enum class Access { read, write };

  /// To read, nothing need be there. To write, makes the archive and its directory, and locks it. Throws
  /// FileError, also when another process writes it, and FormatError when it is something else.
  PackedJobs(std::filesystem::path archive, Access access);
  ~PackedJobs();

  /// Of a file that was torn: bytes behind the last whole job.
  std::uint64_t torn_bytes() const { return torn_bytes_; }

  /// As that of JobRecords, with the outputs in the archive.
  std::string reason_to_run(const BatchJob& job);

  std::vector<RecordedFile> inputs_of(const BatchJob& job);

  /// Appends what the job has written. Throws FileError; the archive is then as it was.
  void write(const BatchJob& job, const std::vector<RecordedFile>& inputs, const HeldFiles& outputs);

  /// Ends the archive, for any program to read, and flushes it to the disk; where outputs have later ones,
  /// writes it anew without them, in one step. Leaves it alone where nothing has changed. Nothing is written
  /// after it. Throws FileError.
  void finish();

 private:
  struct Output {
    std::string name;
    std::uint64_t begin, content, bytes, end;  // in the file
  };
  /// What was appended at a time: a record and its outputs, or an output without one.
  struct Group {
    std::string record;  // a line
    std::uint64_t begin = 0;
    std::vector<Output> outputs;
  };

  struct Held;

  void read();
  std::vector<Group> read_groups();
  bool is_intact(const Group& group) const;
  void add(Group group);
  bool is_current(std::size_t group, const Output& output) const;
  bool is_whole(std::size_t group) const;
  bool has_old_outputs() const;
  void append(Group group, const std::vector<Held>& files);
  std::string tail() const;
  void end_in_place();
  void rewrite() const;

  std::filesystem::path archive_;
  std::filesystem::path directory_;  // the working directory
  std::unique_ptr<RandomAccessFile> file_;
  FileHashes hashes_;
  std::uint64_t torn_bytes_ = 0;

  std::mutex mutex_;  // of all below
  std::vector<Group> groups_;
  std::unordered_map<std::string, std::size_t> group_of_;  // by the output's name: the last
  std::uint64_t end_ = 0;                                  // of the last group
  bool finished_ = false;                                  // and nothing appended since
  bool growing_ = false;                                   // what was behind the last group is cut off
  bool has_damage_ = false;                                // outputs that do not count
};

}  // namespace bespoke
