#include "bespoke/exchange/morphing_mesh.h"

#include <algorithm>
#include <string>
#include <utility>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/apply/motion_jacobian.h"
#include "bespoke/error.h"

namespace bespoke {

namespace {

/// 1/2n, 2/2n, …, 1.
std::vector<double> times_and_halves(int targets) {
  if (targets < 1) throw InvalidInput(std::to_string(targets) + " morph targets; at least one is needed");
  std::vector<double> times;
  for (int k = 1; k <= 2 * targets; ++k) times.push_back(k / (2.0 * targets));
  return times;
}

}  // namespace

MorphingMesh morph_along(Product product, const ElasticMap& elastic, const RigidTransform& target_from_source,
                         int targets, const MotionOptions& motion) {
  const std::vector<double> times = times_and_halves(targets);
  if (product.corners.empty()) throw InvalidInput("a product without faces has no morph targets");
  std::vector<Points> frames =
      apply_mapping(elastic, target_from_source, product.vertices, times, motion).frames;
  MorphingMesh mesh;
  for (std::size_t k = 1; k < frames.size(); k += 2) {
    const Points straight = 0.5 * ((k == 1 ? product.vertices : frames[k - 2]) + frames[k]);
    mesh.off_path = std::max(mesh.off_path, (straight - frames[k - 1]).colwise().norm().maxCoeff());
  }
  for (std::size_t k = 1; k < frames.size(); k += 2) mesh.targets.push_back(frames[k]);
  mesh.product = std::move(product);
  return mesh;
}

MorphSummary morph_file_along(const std::filesystem::path& input, const std::filesystem::path& output,
                              const ElasticMap& elastic, const RigidTransform& target_from_source,
                              const MorphOptions& options) {
  const std::vector<double> times = times_and_halves(options.targets);
  PointMotion points;
  points.frames = times.size();
  points.images = [&](const Points& x) {
    return apply_mapping(elastic, target_from_source, x, times, options.motion).frames;
  };
  points.jacobians = [&](const Points& x) {
    return motion_jacobian(elastic, target_from_source, x, times, options.motion);
  };
  return morph_product(input, output, points, seconds_of_morphing, options.progress);
}

}  // namespace bespoke
