#include "bespoke/batch/forecast.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <string_view>
#include <unordered_map>

#include "bespoke/batch/file_hashes.h"

namespace bespoke {
namespace {

// Of what jobs write: a map of the README's table, a garment of some ten thousand vertices.
constexpr double typical_map_bytes = 8e6;
constexpr double typical_product_bytes = 1e6;

/// seconds = seconds_at_least + seconds_per_byte · bytes of all inputs, and so for memory. Measured on the
/// samples and the pairs of the README's table with one thread (samples/cluster/README.md); export at a grid
/// of 1 %.
struct Rates {
  std::string_view command;
  double seconds_at_least;
  double seconds_per_byte;
  double memory_at_least;
  double memory_per_byte;
};

constexpr std::array rates{Rates{"fit", 2, 3e-6, 2e8, 100},      Rates{"apply", 1e-3, 1e-7, 8e6, 1},
                           Rates{"invert", 2, 1e-6, 2e8, 60},    Rates{"compose", 2, 1e-6, 2e8, 60},
                           Rates{"check", 0.1, 2e-7, 2e7, 20},   Rates{"measure", 0.3, 1e-7, 1e8, 20},
                           Rates{"diff", 0.3, 1.5e-8, 6e7, 5},   Rates{"export", 0.2, 3e-8, 5e7, 12},
                           Rates{"measures", 0.1, 2e-8, 3e8, 1}, Rates{"view", 1, 2e-7, 2e8, 30},
                           Rates{"report", 1, 2e-7, 2e8, 30},    Rates{"picture", 0.1, 2e-8, 5e7, 5}};

// An atlas and the values that it was made of, of a file's byte (the README's look-up table).
constexpr double map_memory_per_byte = 8;

Rates rates_of(std::string_view command) {
  for (const Rates& row : rates)
    if (row.command == command) return row;
  return rates.front();
}

/// Bytes of the inputs, those that jobs write by what is typical.
class InputSizes {
 public:
  double of(const std::filesystem::path& path, bool is_written_by_a_job) {
    const bool is_map = path.extension() == ".vdb";
    if (is_written_by_a_job) return is_map ? typical_map_bytes : typical_product_bytes;
    const auto [known, is_new] = known_.try_emplace(path.string());
    if (is_new) {
      const auto stamp = stamp_of(path);
      known->second = stamp ? static_cast<double>(stamp->bytes) : 0;
    }
    return known->second;
  }

 private:
  std::unordered_map<std::string, double> known_;
};

bool writes(const BatchJob& job, const std::filesystem::path& path) {
  return std::any_of(job.outputs.begin(), job.outputs.end(),
                     [&](const JobFile& output) { return output.path == path; });
}

}  // namespace

std::vector<JobForecast> forecast_jobs(const JobGraph& graph) {
  InputSizes sizes;
  std::vector<JobForecast> forecasts;
  for (std::size_t i = 0; i < graph.jobs.size(); ++i) {
    const BatchJob& job = graph.jobs[i];
    const Rates row = rates_of(job.command);
    JobForecast forecast;
    double bytes = 0;
    for (const JobFile& input : job.inputs) {
      const bool is_made = std::any_of(graph.needs[i].begin(), graph.needs[i].end(), [&](std::size_t need) {
        return writes(graph.jobs[need], input.path);
      });
      const double size = sizes.of(input.path, is_made);
      if (job.shared_map && input.path == *job.shared_map)
        forecast.shared = static_cast<std::size_t>(map_memory_per_byte * size);
      else
        bytes += size;
    }
    forecast.seconds = row.seconds_at_least + row.seconds_per_byte * bytes;
    forecast.memory = static_cast<std::size_t>(row.memory_at_least + row.memory_per_byte * bytes);
    forecasts.push_back(forecast);
  }
  return forecasts;
}

std::vector<std::size_t> jobs_of_shard(const JobGraph& graph, const std::vector<JobForecast>& forecasts,
                                       std::size_t index, std::size_t count) {
  const std::vector<std::vector<std::size_t>> groups = connected_jobs(graph);
  std::vector<double> cost(groups.size(), 0);
  for (std::size_t group = 0; group < groups.size(); ++group)
    for (const std::size_t job : groups[group]) cost[group] += forecasts[job].seconds;
  std::vector<std::size_t> order(groups.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return cost[a] > cost[b]; });
  std::vector<double> load(count, 0);
  std::vector<std::size_t> mine;
  for (const std::size_t group : order) {
    const auto least = static_cast<std::size_t>(std::min_element(load.begin(), load.end()) - load.begin());
    load[least] += cost[group];
    if (least == index) mine.insert(mine.end(), groups[group].begin(), groups[group].end());
  }
  std::sort(mine.begin(), mine.end());
  return mine;
}

}  // namespace bespoke
