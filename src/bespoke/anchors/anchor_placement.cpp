#include "bespoke/anchors/anchor_placement.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/statistics.h"

namespace bespoke {
namespace {

AnchorPlacement placement(std::vector<double> distances, const TriangleMesh& model, const Points& anchors) {
  return {summarize(std::move(distances)).median, diagonal(anchors), diagonal(model.vertices)};
}

}  // namespace

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
  return placement(std::move(distances), model, anchors);
}

std::optional<AnchorPlacement> far_placement(const TriangleMesh& model, const Points& anchors) {
  if (std::vector<double> most = distances_from_vertices(model, anchors);
      !most.empty() && !placement(std::move(most), model, anchors).is_far())
    return std::nullopt;
  const AnchorPlacement placed = anchor_placement(model, anchors);
  return placed.is_far() ? std::optional(placed) : std::nullopt;
}

std::string exchanged_sides(const Anchors& anchors, const TriangleMesh& source, const TriangleMesh& target) {
  const Points a = source_points(anchors), b = target_points(anchors);
  if (!far_placement(source, a) || !far_placement(target, b) || far_placement(target, a) ||
      far_placement(source, b))
    return "";
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
