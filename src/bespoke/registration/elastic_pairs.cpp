#include "bespoke/registration/elastic_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"

namespace bespoke {

ElasticPairs elastic_pairs(const TriangleMesh& source, const Points& fitted) {
  ElasticPairs pairs;
  std::vector<char> used(static_cast<std::size_t>(source.vertices.cols()), 0);
  for (const int vertex : source.faces.reshaped()) used[static_cast<std::size_t>(vertex)] = 1;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) pairs.referenced.push_back(static_cast<int>(i));
  pairs.unreferenced = used.size() - pairs.referenced.size();

  const EqualPositions equal = equal_positions(source.vertices, pairs.referenced);
  std::vector<std::pair<int, Vector3>> places;  // first vertex and mean of the fitted positions
  for (std::size_t group = 0; group < equal.groups(); ++group) {
    Vector3 sum = Vector3::Zero();
    for (const int vertex : equal.group(group)) sum += fitted.col(vertex);
    const std::size_t count = equal.group(group).size();
    places.emplace_back(equal.group(group).front(), sum / static_cast<double>(count));
    pairs.duplicates += count - 1;
  }
  // The vertices' own order, which is usually the more coherent one.
  std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  pairs.sources.resize(3, static_cast<Eigen::Index>(places.size()));
  pairs.targets.resize(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    pairs.sources.col(static_cast<Eigen::Index>(i)) = source.vertices.col(places[i].first);
    pairs.targets.col(static_cast<Eigen::Index>(i)) = places[i].second;
  }
  return pairs;
}

std::vector<std::size_t> anchors_off_surface(const TriangleMesh& source, const Anchors& anchors,
                                             double off_surface) {
  std::vector<std::size_t> found;
  const std::vector<double> most = distances_from_vertices(source, source_points(anchors));
  for (std::size_t i = 0; i < anchors.pairs.size(); ++i)
    if (is_exact(anchors.pairs[i]) && (most.empty() || most[i] > off_surface)) found.push_back(i);
  if (found.empty()) return found;
  const ClosestPointTree surface(source);
  std::erase_if(found, [&](std::size_t i) {
    return surface.closest(anchors.pairs[i].a, {.max_distance = off_surface}).has_value();
  });
  return found;
}

ElasticPairs with_anchors(ElasticPairs pairs, const Anchors& anchors, const std::vector<std::size_t>& which,
                          const RigidTransform& source_from_target) {
  const Eigen::Index places = pairs.sources.cols(), added = static_cast<Eigen::Index>(which.size());
  pairs.sources.conservativeResize(3, places + added);
  pairs.targets.conservativeResize(3, places + added);
  for (Eigen::Index i = 0; i < added; ++i) {
    const AnchorPair& anchor = anchors.pairs[which[static_cast<std::size_t>(i)]];
    pairs.sources.col(places + i) = anchor.a;
    pairs.targets.col(places + i) = source_from_target * anchor.b;
  }
  pairs.anchors_off_surface = which.size();
  return pairs;
}

}  // namespace bespoke
