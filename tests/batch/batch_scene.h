#pragma once

#include <mutex>
#include <string>
#include <vector>

#include "bespoke/atomic_file.h"
#include "bespoke/batch/job_graph.h"
#include "bespoke/error.h"
#include "support/file_text.h"
#include "support/scratch_directory.h"

namespace bespoke::test {

/// Jobs that join the texts of their inputs to their outputs, in a directory of their own, and remember in
/// which order they ran.
class BatchScene {
 public:
  std::filesystem::path file(const std::string& name) const { return directory_ / name; }
  void write(const std::string& name, const std::string& text) const { write_text(file(name), text); }
  std::string read(const std::string& name) const { return read_text(file(name)); }

  BatchJob job(std::size_t line, const std::vector<std::string>& inputs,
               const std::vector<std::string>& outputs) {
    BatchJob job;
    job.line = line;
    job.command = "join";
    for (const std::string& input : inputs) job.inputs.push_back({"product", file(input)});
    for (const std::string& output : outputs) job.outputs.push_back({"output", file(output)});
    job.run = run_of(job);
    return job;
  }

  /// Joins the texts.
  std::function<JobFindings(const Progress&)> run_of(const BatchJob& job) {
    return [this, job](const Progress&) {
      {
        const std::lock_guard lock(mutex_);
        ran.push_back(job.line);
      }
      std::string text;
      for (const JobFile& input : job.inputs) text += read_text(input.path);
      if (text.find("bad") != std::string::npos) throw InvalidInput("the text is bad");
      for (const JobFile& output : job.outputs)
        write_atomically(output.path, [&](const auto& temporary) { write_text(temporary, text); });
      return JobFindings{{{"bytes", text.size()}}, {}, {}};
    };
  }

  std::vector<std::size_t> ran;  ///< lines, by their starts

 private:
  ScratchDirectory directory_;
  std::mutex mutex_;
};

}  // namespace bespoke::test
