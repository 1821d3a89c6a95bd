#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "bespoke/elastic/csrbf.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/elimination_tree.h"

namespace bespoke {
namespace {

void require_usable(const Points& sources, const CsrbfOptions& options) {
  if (!(options.lambda > 0) || !std::isfinite(options.lambda))
    throw InvalidInput("csrbf: effective distance " + std::to_string(options.lambda) +
                       " must be positive and finite");
  if (sources.cols() < 4)
    throw InvalidInput("csrbf needs 4 sources that are not coplanar; there are " +
                       std::to_string(sources.cols()));
  if (!sources.allFinite()) throw InvalidInput("csrbf: a source has a coordinate that is not finite");
}

/// Distance of every point to its nearest other one.
std::vector<double> nearest_distances(const Points& points) {
  const Vector3 extent = points.rowwise().maxCoeff() - points.rowwise().minCoeff();
  // The guess for a surface; each search widens from there until it finds something.
  const double guess = 2 * extent.norm() / std::sqrt(double(points.cols()));
  if (!(guess > 0)) throw InvalidInput("csrbf: all sources lie at one place");
  const PointGrid grid(points, guess);
  std::vector<double> nearest(static_cast<std::size_t>(points.cols()));
  parallel_for(nearest.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      double squared = std::numeric_limits<double>::infinity();
      for (double radius = guess / 4; std::isinf(squared); radius *= 2)
        grid.for_each_within(points.col(Eigen::Index(i)), radius, [&](int j, double candidate) {
          if (std::size_t(j) != i) squared = std::min(squared, candidate);
        });
      nearest[i] = std::sqrt(squared);
    }
  });
  return nearest;
}

void require_distinct(const Points& sources, const std::vector<double>& nearest) {
  const auto first = std::find(nearest.begin(), nearest.end(), 0.0);
  if (first == nearest.end()) return;
  const Eigen::Index i = first - nearest.begin();
  for (Eigen::Index j = 0; j < sources.cols(); ++j)
    if (j != i && sources.col(j) == sources.col(i))
      throw InvalidInput("csrbf: sources " + std::to_string(i) + " and " + std::to_string(j) +
                         " lie at the same place; interpolation needs distinct sources");
}

/// Holds estimates of one set of sources for several λ.
class Estimator {
 public:
  Estimator(const Points& sources, const CsrbfOptions& options) : sources_(sources), options_(options) {
    std::vector<double> nearest = nearest_distances(sources);
    require_distinct(sources, nearest);
    const auto middle = nearest.begin() + std::ptrdiff_t(nearest.size() / 2);
    std::nth_element(nearest.begin(), middle, nearest.end());
    median_spacing_ = *middle;
  }

  CsrbfEstimate at(double lambda) const {
    CsrbfEstimate estimate;
    estimate.centers = static_cast<std::size_t>(sources_.cols());
    estimate.median_spacing = median_spacing_;
    estimate.entries_per_row = entries_per_row(lambda);
    // Measured (tests/accuracy/tuning.md). On a surface the entries of a row grow like (λ/h)², so all of it
    // like (λ/h)⁷.
    constexpr double calibration = 100;
    estimate.condition =
        calibration * estimate.entries_per_row * std::pow(std::max(lambda / median_spacing_, 1.0), 5);
    const double matrix_bytes =
        estimate.entries_per_row * double(estimate.centers) * RadiusGraph::bytes_per_entry;
    estimate.bytes = static_cast<std::size_t>(matrix_bytes);
    estimate.within_limits =
        estimate.condition <= options_.max_condition && matrix_bytes <= double(options_.max_memory);
    if (!estimate.within_limits) return estimate;
    const RadiusGraph graph = radius_graph(sources_, lambda);
    const EliminationTree tree(sources_, graph, lambda);
    estimate.factor_entries = tree.factor_entries();
    estimate.bytes = graph.neighbours.size() * RadiusGraph::bytes_per_entry + tree.peak_bytes();
    estimate.within_limits = estimate.bytes <= options_.max_memory;
    return estimate;
  }

  /// By bisection of log λ between the median spacing and `lambda`, which exceeds a limit.
  double largest_within_limits(double lambda) const {
    constexpr double ratio_wanted = 1.03;
    double good = std::min(median_spacing_, lambda / 2);
    if (!at(good).within_limits) return 0;
    for (double bad = lambda; bad > ratio_wanted * good;) {
      const double middle = std::sqrt(good * bad);
      (at(middle).within_limits ? good : bad) = middle;
    }
    return round_down(good);
  }

 private:
  /// Exact for the rows counted: all, or an even sample of them.
  double entries_per_row(double lambda) const {
    constexpr Eigen::Index max_rows = 1000;
    const Eigen::Index stride = (sources_.cols() + max_rows - 1) / max_rows;
    const PointGrid grid(sources_, lambda);
    const auto rows = static_cast<std::size_t>((sources_.cols() + stride - 1) / stride);
    const auto count = [&](std::size_t begin, std::size_t end) {
      std::size_t entries = 0;
      for (std::size_t row = begin; row < end; ++row)
        grid.for_each_within(sources_.col(Eigen::Index(row) * stride), lambda,
                             [&](int, double) { ++entries; });
      return entries;
    };
    const std::size_t entries =
        parallel_reduce(rows, 16, std::size_t{0}, count, [](std::size_t a, std::size_t b) { return a + b; });
    return double(entries) / double(rows);
  }

  /// To three digits, so that the value as printed stays within the limits.
  static double round_down(double value) {
    const double digit = std::pow(10, std::floor(std::log10(value)) - 2);
    return std::floor(value / digit) * digit;
  }

  const Points& sources_;
  const CsrbfOptions& options_;
  double median_spacing_ = 0;
};

}  // namespace

CsrbfEstimate estimate_csrbf(const Points& sources, const CsrbfOptions& options) {
  require_usable(sources, options);
  const Estimator estimator(sources, options);
  CsrbfEstimate estimate = estimator.at(options.lambda);
  estimate.advised_lambda =
      estimate.within_limits ? options.lambda : estimator.largest_within_limits(options.lambda);
  return estimate;
}

}  // namespace bespoke
