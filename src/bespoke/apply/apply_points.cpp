#include "bespoke/apply/apply_points.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

// A chunk's points and images stay in the cache.
constexpr std::size_t points_per_chunk = 4096;

// Between two reports of progress, some tenths of a second.
constexpr std::size_t points_per_report = std::size_t{1} << 22;

// All products as one stream of points.
class Stream {
 public:
  explicit Stream(std::span<const PointSpans> products) : products_(products) {
    first_.push_back(0);
    for (std::size_t i = 0; i < products.size(); ++i) {
      const std::size_t coordinates = products[i].x.size();
      if (coordinates % 3 != 0 || products[i].image.size() != coordinates)
        throw InvalidInput("product " + std::to_string(i) + ": " + std::to_string(coordinates) +
                           " coordinates of points and space for " +
                           std::to_string(products[i].image.size()) + " of their images");
      first_.push_back(first_.back() + coordinates / 3);
    }
  }

  std::size_t size() const { return first_.back(); }

  Points read(std::size_t begin, std::size_t end) const {
    Points x(3, static_cast<Eigen::Index>(end - begin));
    for_each_part(begin, end, [&](std::size_t product, std::size_t from, std::size_t count, std::size_t at) {
      std::copy_n(products_[product].x.data() + 3 * from, 3 * count, x.data() + 3 * at);
      require_finite(x.data() + 3 * at, product, from, count);
    });
    return x;
  }

  void write(std::size_t begin, const Points& image) const {
    const std::size_t end = begin + static_cast<std::size_t>(image.cols());
    for_each_part(begin, end, [&](std::size_t product, std::size_t to, std::size_t count, std::size_t at) {
      std::copy_n(image.data() + 3 * at, 3 * count, products_[product].image.data() + 3 * to);
    });
  }

 private:
  // body(product, its first point, points, their place in the chunk) for what of [begin, end) lies in each.
  template <class Body>
  void for_each_part(std::size_t begin, std::size_t end, const Body& body) const {
    const auto after = std::upper_bound(first_.begin(), first_.end(), begin);
    for (auto product = static_cast<std::size_t>(after - first_.begin()) - 1, at = begin; at < end;
         ++product) {
      const std::size_t count = std::min(end, first_[product + 1]) - at;
      if (count > 0) body(product, at - first_[product], count, at - begin);
      at += count;
    }
  }

  static void require_finite(const double* x, std::size_t product, std::size_t first, std::size_t count) {
    for (std::size_t i = 0; i < 3 * count; ++i)
      if (!std::isfinite(x[i]))
        throw InvalidInput("product " + std::to_string(product) + ": point " + std::to_string(first + i / 3) +
                           " is not finite");
  }

  std::span<const PointSpans> products_;
  std::vector<std::size_t> first_;  // point of each product, and the end
};

}  // namespace

ApplySummary apply_points(const ElasticMap& elastic, const RigidTransform& target_from_source,
                          std::span<const PointSpans> products, const ApplyPointsOptions& options) {
  const Stopwatch watch;
  const Stream stream(products);
  std::atomic<std::size_t> in_band = 0;
  for (std::size_t done = 0; done < stream.size(); done += points_per_report) {
    options.progress.step("apply", done, stream.size());
    const std::size_t count = std::min(points_per_report, stream.size() - done);
    parallel_for(count, points_per_chunk, [&](std::size_t begin, std::size_t end) {
      options.progress.check();
      const AppliedPoints applied = apply_mapping(
          elastic, target_from_source, stream.read(done + begin, done + end), {options.t}, options.motion);
      stream.write(done + begin, applied.frames.front());
      in_band += applied.summary.in_band;
    });
  }
  options.progress.step("apply", stream.size(), stream.size());
  ApplySummary summary;
  summary.points = stream.size();
  summary.in_band = in_band;
  summary.affine_only = summary.points - summary.in_band;
  summary.seconds = watch.seconds();
  return summary;
}

ApplySummary apply_points(const ElasticMap& elastic, const RigidTransform& target_from_source,
                          const PointSpans& product, const ApplyPointsOptions& options) {
  return apply_points(elastic, target_from_source, std::span(&product, 1), options);
}

}  // namespace bespoke
