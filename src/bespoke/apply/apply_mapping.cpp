#include "bespoke/apply/apply_mapping.h"

#include <chrono>
#include <cmath>
#include <cstdio>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr std::size_t points_per_chunk = 1 << 14;

void require_finite(const Points& x, const std::vector<double>& times) {
  if (!x.allFinite())
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      if (!x.col(i).allFinite())
        throw InvalidInput("point " + std::to_string(i) + " is not finite: (" + std::to_string(x(0, i)) +
                           ", " + std::to_string(x(1, i)) + ", " + std::to_string(x(2, i)) + ")");
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]))
      throw InvalidInput("time " + std::to_string(i) + " is not finite: " + std::to_string(times[i]));
}

std::size_t count_nonzero(const Points& u) {
  return parallel_reduce(
      static_cast<std::size_t>(u.cols()), points_per_chunk, std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t count = 0;
        for (std::size_t i = begin; i < end; ++i)
          count += (u.col(static_cast<Eigen::Index>(i)).array() != 0).any();
        return count;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

}  // namespace

std::string to_string(const ApplySummary& summary) {
  char text[200];
  std::snprintf(text, sizeof text, "%zu points, %zu in the band, %zu by the affine part alone, %.3f s",
                summary.points, summary.in_band, summary.affine_only, summary.seconds);
  return text;
}

AppliedPoints apply_mapping(const ElasticMap& elastic, const RigidTransform& target_from_source,
                            const Points& x, const std::vector<double>& times, const MotionOptions& motion) {
  require_finite(x, times);
  AppliedPoints applied;
  const auto start = std::chrono::steady_clock::now();
  const Points u = elastic.displacement(x);
  // The same sum as ElasticMap::operator(), so that both give the same bits.
  const Points image = elastic.affine() * x + u;
  applied.summary.points = static_cast<std::size_t>(x.cols());
  applied.summary.in_band = count_nonzero(u);
  applied.summary.affine_only = applied.summary.points - applied.summary.in_band;
  applied.summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (const double t : times) applied.frames.push_back(move_points(x, image, target_from_source, t, motion));
  return applied;
}

}  // namespace bespoke
