#pragma once

#include <cstddef>
#include <vector>

#include "bespoke/batch/job_graph.h"

namespace bespoke {

/// What a job will take, by the sizes of its inputs alone: right within a factor of two or so, which is
/// enough to balance shards and to keep a machine from running out of memory.
struct JobForecast {
  double seconds = 0;      ///< on one thread
  std::size_t memory = 0;  ///< bytes, besides the shared map
  std::size_t shared = 0;  ///< bytes of BatchJob::shared_map in memory, once for all its users
};

/// One a job. Inputs that jobs write are taken to be of typical size whether they are there already or not,
/// so that every shard forecasts the same.
std::vector<JobForecast> forecast_jobs(const JobGraph& graph);

/// The jobs of shard `index` (from 0) of `count`: groups of connected jobs, the costliest first, each to the
/// shard with the least to do so far. Ascending.
std::vector<std::size_t> jobs_of_shard(const JobGraph& graph, const std::vector<JobForecast>& forecasts,
                                       std::size_t index, std::size_t count);

}  // namespace bespoke
