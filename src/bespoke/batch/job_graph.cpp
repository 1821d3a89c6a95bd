#include "bespoke/batch/job_graph.h"

#include <algorithm>
#include <string>
#include <unordered_map>
#include <utility>

#include "bespoke/mesh/disjoint_sets.h"

namespace bespoke {
namespace {

namespace fs = std::filesystem;

/// Names of files such that two names of one file become the same. Directories are looked up once.
class FileNames {
 public:
  std::string of(const fs::path& path) {
    std::error_code error;
    const fs::path directory = path.has_parent_path() ? path.parent_path() : ".";
    auto [known, is_new] = directories_.try_emplace(directory.string());
    if (is_new) {
      known->second = fs::weakly_canonical(fs::absolute(directory), error);
      if (error) known->second = fs::absolute(directory).lexically_normal();
    }
    const fs::path name = known->second / path.filename();
    if (!fs::is_symlink(fs::symlink_status(name, error))) return name.string();
    const fs::path target = fs::weakly_canonical(name, error);
    return error ? name.string() : target.string();
  }

 private:
  std::unordered_map<std::string, fs::path> directories_;
};

using Writers = std::unordered_map<std::string, std::size_t>;

Writers writers_of(const std::vector<BatchJob>& jobs, FileNames& names, std::vector<ManifestFault>& faults) {
  Writers writers;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    for (const JobFile& output : jobs[i].outputs) {
      const auto [first, is_new] = writers.try_emplace(names.of(output.path), i);
      if (is_new) continue;
      const std::string other =
          first->second == i ? "by this job already" : "by line " + std::to_string(jobs[first->second].line);
      faults.push_back({jobs[i].line, output.role + " " + output.path.string() + " is written " + other});
    }
  return writers;
}

void add_needs(const Writers& writers, FileNames& names, JobGraph& graph) {
  std::unordered_map<std::string, bool> exists;
  for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
    for (const JobFile& input : graph.jobs[i].inputs) {
      const std::string name = names.of(input.path);
      const std::string what = input.role + " " + input.path.string();
      if (const auto writer = writers.find(name); writer != writers.end()) {
        if (writer->second == i)
          graph.faults.push_back({graph.jobs[i].line, what + " is also what the job writes"});
        else
          graph.needs[i].push_back(writer->second);
        continue;
      }
      const auto [known, is_new] = exists.try_emplace(name);
      std::error_code ignored;
      if (is_new) known->second = fs::exists(name, ignored);
      if (!known->second)
        graph.faults.push_back({graph.jobs[i].line, what + " does not exist, and no job writes it"});
    }
    std::sort(graph.needs[i].begin(), graph.needs[i].end());
    graph.needs[i].erase(std::unique(graph.needs[i].begin(), graph.needs[i].end()), graph.needs[i].end());
  }
}

void add_feeds(JobGraph& graph) {
  for (std::size_t i = 0; i < graph.jobs.size(); ++i)
    for (const std::size_t need : graph.needs[i]) graph.feeds[need].push_back(i);
}

/// The jobs that never become ready, because they wait for each other or for such jobs.
std::vector<std::size_t> never_ready(const JobGraph& graph) {
  std::vector<std::size_t> waits(graph.jobs.size()), ready;
  for (std::size_t i = 0; i < waits.size(); ++i)
    if ((waits[i] = graph.needs[i].size()) == 0) ready.push_back(i);
  while (!ready.empty()) {
    const std::size_t job = ready.back();
    ready.pop_back();
    for (const std::size_t fed : graph.feeds[job])
      if (--waits[fed] == 0) ready.push_back(fed);
  }
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < waits.size(); ++i)
    if (waits[i] > 0) left.push_back(i);
  return left;
}

/// Names one cycle: from a job that never becomes ready back along what it waits for, until a job repeats.
void add_cycle(JobGraph& graph) {
  const std::vector<std::size_t> left = never_ready(graph);
  if (left.empty()) return;
  std::vector<std::size_t> way;
  for (std::size_t next = left.front();;) {
    way.push_back(next);
    const std::vector<std::size_t>& needs = graph.needs[next];
    next = *std::find_if(needs.begin(), needs.end(), [&](std::size_t need) {
      return std::binary_search(left.begin(), left.end(), need);
    });
    const auto seen = std::find(way.begin(), way.end(), next);
    if (seen != way.end()) {
      way.erase(way.begin(), seen);
      way.push_back(next);
      break;
    }
  }
  std::string lines;
  for (const std::size_t job : way)
    lines += (lines.empty() ? "" : ", which waits for ") + ("line " + std::to_string(graph.jobs[job].line));
  graph.faults.push_back({graph.jobs[way.front()].line, "waits for itself: " + lines});
}

}  // namespace

JobGraph make_job_graph(std::vector<BatchJob> jobs) {
  JobGraph graph;
  graph.jobs = std::move(jobs);
  graph.needs.resize(graph.jobs.size());
  graph.feeds.resize(graph.jobs.size());
  FileNames names;
  const Writers writers = writers_of(graph.jobs, names, graph.faults);
  add_needs(writers, names, graph);
  add_feeds(graph);
  add_cycle(graph);
  std::stable_sort(graph.faults.begin(), graph.faults.end(),
                   [](const auto& a, const auto& b) { return a.line < b.line; });
  return graph;
}

std::vector<std::vector<std::size_t>> connected_jobs(const JobGraph& graph) {
  DisjointSets sets(static_cast<int>(graph.jobs.size()));
  for (std::size_t i = 0; i < graph.jobs.size(); ++i)
    for (const std::size_t need : graph.needs[i]) sets.join(static_cast<int>(i), static_cast<int>(need));
  std::vector<std::vector<std::size_t>> groups;
  std::unordered_map<int, std::size_t> group_of;
  for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
    const auto [group, is_new] = group_of.try_emplace(sets.least(static_cast<int>(i)), groups.size());
    if (is_new) groups.emplace_back();
    groups[group->second].push_back(i);
  }
  return groups;
}

JobGraph subgraph(JobGraph graph, const std::vector<std::size_t>& jobs) {
  std::vector<std::size_t> index(graph.jobs.size(), graph.jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) index[jobs[i]] = i;
  const auto renumbered = [&](std::vector<std::size_t> list) {
    for (std::size_t& job : list) job = index[job];
    return list;
  };
  JobGraph part;
  for (const std::size_t job : jobs) {
    part.jobs.push_back(std::move(graph.jobs[job]));
    part.needs.push_back(renumbered(std::move(graph.needs[job])));
    part.feeds.push_back(renumbered(std::move(graph.feeds[job])));
  }
  return part;
}

}  // namespace bespoke
