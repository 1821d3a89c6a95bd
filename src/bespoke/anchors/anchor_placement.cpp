#include "bespoke/anchors/anchor_placement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/statistics.h"

namespace bespoke {

bool AnchorPlacement::is_far() const {
  constexpr double farthest_plausible = 0.25;
  const double spread = anchor_diagonal > 0 ? std::min(anchor_diagonal, model_diagonal) : model_diagonal;
  return median_distance > farthest_plausible * spread;
}

AnchorPlacement anchor_placement(const TriangleMesh& model, const Points& anchors) {
  if (anchors.cols() == 0) return {};
  const ClosestPointTree tree(model);
  std::vector<double> distances;
  for (const auto& anchor : anchors.colwise())
    distances.push_back(std::sqrt(tree.closest(Vector3(anchor))->squared_distance));
  return {summarize(std::move(distances)).median, diagonal(anchors), diagonal(model.vertices)};
}

std::string to_string(const AnchorPlacement& placement) {
  char text[160];
  std::snprintf(text, sizeof text,
                "half of the anchors lie %.4g or more from the model; they span %.4g, the model %.4g",
                placement.median_distance, placement.anchor_diagonal, placement.model_diagonal);
  return text;
}

}  // namespace bespoke
