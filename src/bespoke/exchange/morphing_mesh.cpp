#include "bespoke/exchange/morphing_mesh.h"

#include <algorithm>
#include <utility>

#include "bespoke/apply/apply_mapping.h"
#include "bespoke/error.h"

namespace bespoke {

MorphingMesh morph_along(Product product, const ElasticMap& elastic, const RigidTransform& target_from_source,
                         int targets, const MotionOptions& motion) {
  if (targets < 1) throw InvalidInput(std::to_string(targets) + " morph targets; at least one is needed");
  if (product.corners.empty()) throw InvalidInput("a product without faces has no morph targets");
  std::vector<double> times;
  for (int k = 0; k <= 2 * targets; ++k) times.push_back(k / (2.0 * targets));
  std::vector<Points> frames =
      apply_mapping(elastic, target_from_source, product.vertices, times, motion).frames;
  MorphingMesh mesh;
  for (std::size_t k = 1; k < frames.size(); k += 2) {
    const Points straight = 0.5 * (frames[k - 1] + frames[k + 1]);
    mesh.off_path = std::max(mesh.off_path, (straight - frames[k]).colwise().norm().maxCoeff());
  }
  for (std::size_t k = 2; k < frames.size(); k += 2) mesh.targets.push_back(std::move(frames[k]));
  mesh.product = std::move(product);
  return mesh;
}

}  // namespace bespoke
