#include "bespoke/apply/apply_mapping.h"

#include <cmath>
#include <cstdio>
#include <numeric>

#include "bespoke/apply/detail/followed_chain.h"
#include "bespoke/error.h"
#include "bespoke/mapping/reach.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"

namespace bespoke {
namespace {

constexpr std::size_t points_per_mapping_chunk = 1 << 14;

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

/// Whether elastic_argument returns x itself.
bool is_at_rest(double t, const MotionOptions& motion) {
  return motion.order != MappingOrder::moving_point || t == 0 || t == 1;
}

/// Replaces the frames between the ends by those of the chain's own motion.
void follow(const ElasticChain& chain, const RigidTransform& target_from_source, const Points& x,
            const std::vector<double>& times, AppliedPoints& applied) {
  std::vector<double> between;
  for (const double t : times)
    if (t != 0 && t != 1) between.push_back(t);
  if (between.empty()) return;
  const Stopwatch watch;
  const std::vector<Points> images = chain.at(x, between);
  applied.summary.seconds += watch.seconds();
  std::size_t next = 0;
  for (std::size_t frame = 0; frame < times.size(); ++frame) {
    if (times[frame] == 0 || times[frame] == 1) continue;
    const Points& image = images[next++];
    // R(t) image + t T.
    applied.frames[frame] = move_points(image, image, target_from_source, times[frame]);
  }
}

}  // namespace

std::string to_string(const ApplySummary& summary) {
  char text[200];
  std::snprintf(text, sizeof text,
                "%zu points: %zu within reach of the source, %zu beyond it and moved with the whole; %.3f s",
                summary.points, summary.in_band, summary.affine_only, summary.seconds);
  return text;
}

ImageOfPoints image_at(const ElasticMap& elastic, const RigidTransform& target_from_source, double t,
                       const MotionOptions& motion) {
  return [&elastic, target_from_source, t, motion](const Points& x) -> Points {
    return std::move(apply_mapping(elastic, target_from_source, x, {t}, motion).frames.front());
  };
}

AppliedPoints apply_mapping(const ElasticMap& elastic, const RigidTransform& target_from_source,
                            const Points& x, const std::vector<double>& times, const MotionOptions& motion) {
  require_finite(x, times);
  AppliedPoints applied;
  Stopwatch watch;
  const Points u = elastic.displacement(x);
  applied.summary.seconds = watch.lap();

  applied.frames.assign(times.size(), Points(3, x.cols()));
  const AffineMap affine = elastic.affine();
  const auto count = static_cast<std::size_t>(x.cols());
  std::vector<std::size_t> in_band((count + points_per_mapping_chunk - 1) / points_per_mapping_chunk);
  parallel_for(count, points_per_mapping_chunk, [&](std::size_t begin, std::size_t end) {
    const auto first = static_cast<Eigen::Index>(begin);
    const auto size = static_cast<Eigen::Index>(end - begin);
    const Points chunk = x.middleCols(first, size);
    const Points u_chunk = u.middleCols(first, size);
    const Points image = affine * chunk + u_chunk;
    in_band[begin / points_per_mapping_chunk] = count_in_reach(elastic, chunk, u_chunk);
    for (std::size_t frame = 0; frame < times.size(); ++frame)
      if (is_at_rest(times[frame], motion))
        applied.frames[frame].middleCols(first, size) =
            move_points(chunk, image, target_from_source, times[frame], motion);
  });
  if (const ElasticChain* chain = followed_chain(elastic, motion))
    follow(*chain, target_from_source, x, times, applied);
  // Every t has a lookup of its own where E is requested at points that move.
  for (std::size_t frame = 0; frame < times.size(); ++frame) {
    if (is_at_rest(times[frame], motion)) continue;
    const Points argument = elastic_argument(x, target_from_source, times[frame], motion);
    watch.lap();
    const Points image = elastic(argument);
    applied.summary.seconds += watch.lap();
    applied.frames[frame] = move_points(x, image, target_from_source, times[frame], motion);
  }
  applied.summary.points = count;
  applied.summary.in_band = std::accumulate(in_band.begin(), in_band.end(), std::size_t{0});
  applied.summary.affine_only = count - applied.summary.in_band;
  return applied;
}

}  // namespace bespoke
