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

std::string exchanged_sides(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target) {
  const Points a = source_points(anchors), b = target_points(anchors);
  const auto far = [](const TriangleMesh& model, const Points& side) {
    return anchor_placement(model, side).is_far();
  };
  if (!far(source, a) || !far(target, b) || far(target, a) || far(source, b)) return "";
  return "\"a\" of the anchors lies at the target and \"b\" at the source: the two models, or the anchors' "
         "sides, are exchanged";
}

std::string to_string(const AnchorPlacement& placement) {
  char text[160];
  std::snprintf(text, sizeof text,
                "half of the anchors lie %.4g or more from the model; they span %.4g, the model %.4g",
                placement.median_distance, placement.anchor_diagonal, placement.model_diagonal);
  return text;
}

}  // namespace bespoke
