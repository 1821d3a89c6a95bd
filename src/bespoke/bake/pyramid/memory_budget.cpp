#include "bespoke/bake/pyramid/memory_budget.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <utility>

#include "bespoke/error.h"

namespace bespoke {
namespace {

// Five arrays of values at most: the samples, the values that balance them, a pyramid, the one that may
// replace it, and the stored sums that the latter's residuals are taken against; coordinates, tables, and the
// index that the look-up needs (measured: up to 8 entries of 112 bytes for a leaf that stands alone).
constexpr std::size_t bytes_per_leaf = 5 * leaf_floats * sizeof(float) + 1500;
constexpr std::size_t fixed_bytes = std::size_t{48} << 20;
// Below this many leaves, and this share of the memory, a forecast costs more than it may save.
constexpr std::size_t leaves_without_forecast = 4096;
constexpr std::size_t share_without_forecast = 16;
// A forecast errs: advice keeps this distance from the limit.
constexpr double advice_margin = 1.6;

double megabytes(double bytes) { return bytes / 0x1p20; }

}  // namespace

MemoryBudget::MemoryBudget(const ElasticMap& map, const Lattice& coarsest, std::vector<LeafCoordinates> band,
                           const RefinementOptions& options, const Progress& progress)
    : map_(map), coarsest_(coarsest), band_(std::move(band)), options_(options), progress_(progress) {}

std::size_t MemoryBudget::bytes_for(std::size_t leaves) { return fixed_bytes + bytes_per_leaf * leaves; }

void MemoryBudget::require_space_for(std::size_t leaves) {
  const std::size_t needed = bytes_for(leaves);
  const bool small =
      leaves <= leaves_without_forecast && needed <= options_.max_memory / share_without_forecast;
  const double expected = small || options_.max_leaves ? 0 : expected_leaves();
  if (std::max(static_cast<double>(needed), fixed_bytes + bytes_per_leaf * expected) >
      static_cast<double>(options_.max_memory))
    refuse(leaves, expected);
}

double MemoryBudget::expected_leaves() {
  if (band_.empty()) return 0;
  if (!forecast_)
    forecast_ =
        std::make_shared<LeafForecast>(map_, coarsest_, band_, options_.tolerance, options_.nodes, progress_);
  return forecast_->leaves(options_.tolerance);
}

void MemoryBudget::refuse(std::size_t leaves, double expected) const {
  const double bytes = fixed_bytes + bytes_per_leaf * std::max(static_cast<double>(leaves), expected);
  const double affordable = (static_cast<double>(options_.max_memory) - fixed_bytes) / bytes_per_leaf;
  char text[300];
  int length = std::snprintf(
      text, sizeof text, "a tolerance of %.4g needs about %.0f MB for the bake, the limit is %.0f MB",
      options_.tolerance, std::ceil(megabytes(bytes)), megabytes(static_cast<double>(options_.max_memory)));
  // Where the forecast was too low, what it says about other tolerances is too low as well.
  const double shortfall = expected > 0 ? std::max(1.0, static_cast<double>(leaves) / expected) : 1;
  const std::optional<double> fitting =
      forecast_ ? forecast_->tolerance_for(affordable / (advice_margin * shortfall)) : std::nullopt;
  const std::size_t left = sizeof text - static_cast<std::size_t>(length);
  if (fitting)
    std::snprintf(text + length, left, "; a tolerance of %.4g would fit",
                  std::max(1.01 * *fitting, 1.1 * options_.tolerance));
  else
    std::snprintf(
        text + length, left, "; no tolerance fits, allow at least %.0f MB",
        std::ceil(megabytes(fixed_bytes +
                            2.0 * bytes_per_leaf * static_cast<double>(std::max(band_.size(), leaves)))));
  throw MemoryLimitError(text);
}

}  // namespace bespoke
