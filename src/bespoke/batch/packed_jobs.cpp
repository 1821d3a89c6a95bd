#include "bespoke/batch/packed_jobs.h"

#include <sys/resource.h>

#include <algorithm>
#include <ctime>
#include <map>
#include <optional>
#include <utility>

#include "bespoke/batch/detail/random_access_file.h"
#include "bespoke/batch/detail/tar_format.h"
#include "bespoke/batch/job_records.h"
#include "bespoke/error.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

// What tells an archive of ours, and a record in it, from other comments. The number goes up with the layout.
const std::string mark_text = "bespoke batch archive 1";
const std::string record_prefix = "bespoke job ";

constexpr std::uint64_t chunk_bytes = 1 << 20;

/// The same for every name of a file.
fs::path whole_name(const fs::path& path) { return fs::weakly_canonical(fs::absolute(path)); }

/// By what an archive that is unpacked in this directory calls the file.
std::string member_name(const fs::path& path, const fs::path& directory) {
  fs::path name = path.lexically_normal();
  if (name.is_absolute() || *name.begin() == "..") name = whole_name(path).lexically_relative(directory);
  if (name.empty() || *name.begin() == "..")
    throw InvalidInput(path.string() + " lies outside the working directory " + directory.string() +
                       ", so it has no place in an archive that is unpacked there");
  return name.string();
}

/// Outputs wait in open files, of which a process may have a thousand unless it requires more.
void allow_many_open_files() {
  rlimit limit;
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

/// Writes from a place on, in large pieces.
class Appender {
 public:
  Appender(RandomAccessFile& file, std::uint64_t begin) : file_(file), begin_(begin) {}

  std::uint64_t place() const { return begin_ + buffer_.size(); }
  void put(std::string_view bytes) {
    buffer_ += bytes;
    if (buffer_.size() >= chunk_bytes) flush();
  }
  void put_from(const RandomAccessFile& file, std::uint64_t begin, std::uint64_t end) {
    for (; begin < end; begin += chunk_bytes) put(file.read(begin, std::min(chunk_bytes, end - begin)));
  }
  void flush() {
    file_.write(begin_, buffer_);
    begin_ += buffer_.size();
    buffer_.clear();
  }

 private:
  RandomAccessFile& file_;
  std::uint64_t begin_;
  std::string buffer_;
};

std::string hash_of(const RandomAccessFile& file, std::uint64_t begin, std::uint64_t bytes) {
  Sha256 hash;
  for (std::uint64_t done = 0; done < bytes; done += chunk_bytes) {
    const std::string chunk = file.read(begin + done, std::min(chunk_bytes, bytes - done));
    hash.update(chunk.data(), chunk.size());
  }
  return hash.finish();
}

bool is_file_of_records(const std::string& name) {
  return fs::path(name).parent_path().filename() == unpacked_records({});
}

std::string whole_member(const std::string& name, const std::string& content) {
  return tar_header(name, content.size(), std::time(nullptr)) + content + tar_padding(content.size());
}

}  // namespace

/// A file that is appended.
struct PackedJobs::Held {
  std::string name;
  std::int64_t modified;  ///< seconds since 1970
  std::unique_ptr<RandomAccessFile> content;
  std::uint64_t bytes;
};

bool is_packed(const JobGraph& graph, std::size_t job) {
  return graph.feeds[job].empty() && !graph.jobs[job].outputs.empty();
}

std::vector<ManifestFault> packing_faults(const JobGraph& graph, const fs::path& archive) {
  const fs::path directory = fs::canonical(fs::current_path()), own = whole_name(archive);
  const auto is_archive = [&](const JobFile& file) {
    return file.path.filename() == archive.filename() && whole_name(file.path) == own;
  };
  std::vector<ManifestFault> faults;
  for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
    const BatchJob& job = graph.jobs[i];
    for (const std::vector<JobFile>* files : {&job.inputs, &job.outputs})
      for (const JobFile& file : *files)
        if (is_archive(file)) faults.push_back({job.line, named(file) + " is the archive itself"});
    if (!is_packed(graph, i)) continue;
    for (const JobFile& output : job.outputs) try {
        member_name(output.path, directory);
      } catch (const InvalidInput& error) {
        faults.push_back({job.line, output.role + " " + error.what()});
      }
  }
  return faults;
}

PackedJobs::PackedJobs(fs::path archive, Access access)
    : archive_(std::move(archive)), directory_(fs::canonical(fs::current_path())) {
  using FileAccess = RandomAccessFile::Access;
  if (access == Access::read) {
    if (!fs::exists(archive_)) return;
    file_ = std::make_unique<RandomAccessFile>(archive_, FileAccess::read);
  } else {
    if (archive_.has_parent_path()) make_directories(archive_.parent_path());
    file_ = std::make_unique<RandomAccessFile>(archive_, FileAccess::write_alone);
    allow_many_open_files();
  }
  read();
}

PackedJobs::~PackedJobs() = default;

void PackedJobs::read() {
  const std::uint64_t bytes = file_->size();
  const std::string mark = tar_comment(mark_text);
  if (!mark.starts_with(file_->read(0, mark.size())))
    throw FormatError(archive_.string() +
                      ": is not an archive that `bespoke batch --pack` has made; give another name");
  std::vector<Group> groups;
  if (bytes >= mark.size()) groups = read_groups();
  if (!finished_) {
    torn_bytes_ = bytes - end_;
    has_damage_ = std::erase_if(groups, [&](const Group& group) { return !is_intact(group); }) > 0;
  }
  for (Group& group : groups) add(std::move(group));
}

std::vector<PackedJobs::Group> PackedJobs::read_groups() {
  std::vector<Group> groups;
  TarReader reader(*file_);
  Group open;
  std::size_t missing = 0;  // outputs of the open group
  end_ = reader.next()->end;
  while (const std::optional<TarMember> member = reader.next()) {
    if (member->kind == TarMember::Kind::comment && member->comment.starts_with(record_prefix)) {
      open = {member->comment.substr(record_prefix.size()), member->begin, {}};
      const std::optional<JobRecord> record = parse_job_record(open.record);
      missing = record ? record->outputs.size() : 0;
    } else {
      if (missing == 0 && is_file_of_records(member->name)) continue;
      if (missing == 0) open = {{}, member->begin, {}};
      open.outputs.push_back({member->name, member->begin, member->content, member->bytes, member->end});
      if (missing > 0 && --missing > 0) continue;
      groups.push_back(std::exchange(open, {}));
      end_ = member->end;
    }
  }
  finished_ = reader.is_ended() && missing == 0;
  return groups;
}

bool PackedJobs::is_intact(const Group& group) const {
  if (group.record.empty()) return true;
  const std::optional<JobRecord> record = parse_job_record(group.record);
  return std::equal(group.outputs.begin(), group.outputs.end(), record->outputs.begin(),
                    record->outputs.end(), [&](const Output& output, const RecordedFile& recorded) {
                      return recorded.content.stamp.bytes == output.bytes &&
                             recorded.content.hash == hash_of(*file_, output.content, output.bytes);
                    });
}

void PackedJobs::add(Group group) {
  for (const Output& output : group.outputs) group_of_[output.name] = groups_.size();
  groups_.push_back(std::move(group));
}

bool PackedJobs::is_current(std::size_t group, const Output& output) const {
  return group_of_.at(output.name) == group;
}

bool PackedJobs::is_whole(std::size_t group) const {
  const std::vector<Output>& outputs = groups_[group].outputs;
  return !groups_[group].record.empty() &&
         std::all_of(outputs.begin(), outputs.end(), [&](const auto& o) { return is_current(group, o); });
}

bool PackedJobs::has_old_outputs() const {
  std::size_t outputs = 0;
  for (const Group& group : groups_) outputs += group.outputs.size();
  return outputs > group_of_.size();
}

std::string PackedJobs::reason_to_run(const BatchJob& job) {
  Group group;
  {
    const std::lock_guard lock(mutex_);
    const auto found = group_of_.find(member_name(job.outputs.front().path, directory_));
    if (found == group_of_.end()) return named(job.outputs.front()) + " is not in the archive";
    if (!is_whole(found->second)) return "there is no record of it";
    group = groups_[found->second];
  }
  const std::optional<JobRecord> record = parse_job_record(group.record);
  if (std::string reason = changed_since(*record, job, hashes_); !reason.empty()) return reason;
  if (group.outputs.size() < job.outputs.size()) return "it has other outputs";
  for (std::size_t i = 0; i < job.outputs.size(); ++i)
    if (group.outputs[i].name != member_name(job.outputs[i].path, directory_)) return "it has other outputs";
  return {};
}

std::vector<RecordedFile> PackedJobs::inputs_of(const BatchJob& job) { return recorded_inputs(job, hashes_); }

void PackedJobs::write(const BatchJob& job, const std::vector<RecordedFile>& inputs,
                       const HeldFiles& outputs) {
  std::vector<HeldFiles::File> left = outputs.files();
  std::vector<std::pair<JobFile, fs::path>> files;  // and where they can be read
  for (const JobFile& output : job.outputs) {
    const auto file = std::find_if(left.begin(), left.end(),
                                   [&](const HeldFiles::File& held) { return held.path == output.path; });
    if (file == left.end()) throw FileError(named(output) + " was not written");
    files.emplace_back(output, file->content);
    left.erase(file);
  }
  for (const HeldFiles::File& further : left)
    files.emplace_back(JobFile{"further", further.path}, further.content);

  constexpr std::int64_t nanoseconds = 1'000'000'000;
  JobRecord record = record_of(job, inputs);
  std::vector<Held> held;
  for (const auto& [file, place] : files) {
    auto content = std::make_unique<RandomAccessFile>(place, RandomAccessFile::Access::read, file.path);
    const std::uint64_t bytes = content->size();
    const std::int64_t now = std::time(nullptr);
    record.outputs.push_back({file.role,
                              file.path.lexically_proximate(record_directory(job)).string(),
                              {{bytes, now * nanoseconds}, false, hash_of(*content, 0, bytes)}});
    held.push_back({member_name(file.path, directory_), now, std::move(content), bytes});
  }
  append({to_line(record), 0, {}}, held);
}

void PackedJobs::append(Group group, const std::vector<Held>& files) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(growing_, true)) file_->cut(end_);
  finished_ = false;
  Appender appender(*file_, end_);
  try {
    if (end_ == 0) appender.put(tar_comment(mark_text));
    group.begin = appender.place();
    appender.put(tar_comment(record_prefix + group.record));
    for (const Held& file : files) {
      Output output{file.name, appender.place(), 0, file.bytes, 0};
      appender.put(tar_header(file.name, file.bytes, file.modified));
      output.content = appender.place();
      appender.put_from(*file.content, 0, file.bytes);
      appender.put(tar_padding(file.bytes));
      output.end = appender.place();
      group.outputs.push_back(std::move(output));
    }
    appender.flush();
  } catch (const FileError&) {
    file_->cut(end_);
    throw;
  }
  end_ = appender.place();
  add(std::move(group));
}

std::string PackedJobs::tail() const {
  std::map<std::string, std::string> lines;  // by directory
  for (std::size_t i = 0; i < groups_.size(); ++i)
    if (is_whole(i))
      lines[fs::path(groups_[i].outputs.front().name).parent_path().string()] += groups_[i].record + "\n";
  std::string members;
  constexpr std::size_t digits = 16;
  for (const auto& [directory, text] : lines) {
    // Archives that are unpacked in one place must not take each other's records away.
    const std::string name = sha256(text.data(), text.size()).substr(0, digits) + ".jsonl";
    members += whole_member((unpacked_records(directory) / name).string(), text);
  }
  return members;
}

void PackedJobs::end_in_place() {
  file_->cut(end_);
  Appender appender(*file_, end_);
  try {
    if (end_ == 0) appender.put(tar_comment(mark_text));
    appender.put(tail());
    appender.flush();
    // An archive with an end has all of its content on the disk.
    file_->flush();
    appender.put(tar_end());
    appender.flush();
    file_->flush();
  } catch (const FileError&) {
    // Programs read an archive without an end, but not one that ends within a member.
    file_->cut(end_);
    throw;
  }
}

void PackedJobs::rewrite() const {
  write_atomically(archive_, [&](const fs::path& temporary) {
    RandomAccessFile file(temporary, RandomAccessFile::Access::write, archive_);
    Appender appender(file, 0);
    appender.put(tar_comment(mark_text));
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      const std::vector<Output>& outputs = groups_[i].outputs;
      if (is_whole(i)) appender.put_from(*file_, groups_[i].begin, outputs.front().begin);
      for (const Output& output : outputs)
        if (is_current(i, output)) appender.put_from(*file_, output.begin, output.end);
    }
    appender.put(tail());
    appender.put(tar_end());
    appender.flush();
  });
}

void PackedJobs::finish() {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  if (!has_damage_) end_in_place();
  finished_ = true;
  if (has_damage_ || has_old_outputs()) rewrite();
}

}  // namespace bespoke
