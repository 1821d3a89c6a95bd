#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/batch/batch_job.h"
#include "bespoke/batch/manifest.h"

namespace bespoke {

/// Jobs and which of them wait for which.
struct JobGraph {
  std::vector<BatchJob> jobs;
  std::vector<std::vector<std::size_t>> needs;  ///< a job: the jobs whose outputs it reads, ascending
  std::vector<std::vector<std::size_t>> feeds;  ///< a job: the jobs that read its outputs, ascending
  std::vector<ManifestFault> faults;            ///< sorted by line; with any, nothing may run
};

/// Joins jobs by their files. Faults are: an input that neither exists nor is written by a job, an output of
/// two jobs, a job that reads what it writes, and jobs that wait for each other; each names its line and the
/// others that take part. Two names of one file count as one.
JobGraph make_job_graph(std::vector<BatchJob> jobs);

/// The jobs that hang together through their files, each group in ascending order, in the order of their
/// first jobs.
std::vector<std::vector<std::size_t>> connected_jobs(const JobGraph& graph);

/// The same graph of fewer jobs: those whose files hang together with none that is left out.
JobGraph subgraph(JobGraph graph, const std::vector<std::size_t>& jobs);

}  // namespace bespoke
