#include "bespoke/anchor_checks/stretching_anchors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/surface_paths.h"
#include "bespoke/mesh/triangle_mesh.h"
#include "bespoke/rigid/similarity_alignment.h"

namespace bespoke {
namespace {

struct Contradiction {
  std::size_t first, second;
  double difference;  // of distances, mesh units on the target
};

/// Distances between points along a surface.
class PathDistances {
 public:
  PathDistances(const TriangleMesh& mesh, const Points& points) : mesh_(mesh), points_(points) {}

  /// At least so far, but for what paths over a mesh are too long (8 %); infinite where no path leads.
  double operator()(Eigen::Index i, Eigen::Index j) {
    const Foot& from = foot(i);
    const Foot& to = foot(j);
    if (from.lengths.size() == 0) feet_.at(i).lengths = path_lengths(*graph_, from.corners);
    const double path = length_to(from.lengths, to.corners) - from.edge - to.edge;
    return std::max((points_.col(j) - points_.col(i)).norm(), path);
  }

 private:
  struct Foot {
    std::array<PathStart, 3> corners;  // of the face that the point lies on
    double edge = 0;                   // the longest of that face: a path by its corners is longer by less
    Eigen::VectorXd lengths;           // to all vertices, once they are asked for
  };

  const Foot& foot(Eigen::Index i) {
    if (const auto known = feet_.find(i); known != feet_.end()) return known->second;
    if (!graph_) {
      tree_.emplace(mesh_);
      graph_.emplace(edge_and_crossing_graph(mesh_));
    }
    const SurfacePoint place = *tree_->closest(points_.col(i));
    Foot foot{path_starts(mesh_, place), 0, {}};
    for (Eigen::Index k = 0; k < 3; ++k)
      foot.edge = std::max(foot.edge, (mesh_.vertices.col(mesh_.faces((k + 1) % 3, place.face)) -
                                       mesh_.vertices.col(mesh_.faces(k, place.face)))
                                          .norm());
    return feet_.emplace(i, std::move(foot)).first->second;
  }

  const TriangleMesh& mesh_;
  const Points& points_;
  std::optional<ClosestPointTree> tree_;
  std::optional<SurfaceGraph> graph_;
  std::map<Eigen::Index, Foot> feet_;
};

}  // namespace

std::vector<double> sigmas_within_stretch(const Anchors& anchors, std::size_t count,
                                          const TriangleMesh& source, const TriangleMesh& target,
                                          double max_stretch) {
  constexpr std::size_t min_pairs = 4;  // fewer tell no size
  // Of the targets' diagonal: two places, each accurate to anchor_resolution in every coordinate.
  constexpr double explained = std::numbers::sqrt2 * std::numbers::sqrt3 * 1e-3;
  std::vector<double> sigmas(count, 0);
  const Points sources = source_points(anchors), targets = target_points(anchors);
  if (anchors.pairs.size() < min_pairs || !(diagonal(sources) > 0) || !(diagonal(targets) > 0)) return sigmas;
  const double size = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols())).scale;
  const double noise = explained * diagonal(targets);
  PathDistances along_source(source, sources), along_target(target, targets);
  /// By how much one distance exceeds the other one stretched; 0 where it does not.
  const auto excess = [&](double distance, double other) {
    return distance > max_stretch * other && distance - other > noise ? distance - other : 0;
  };
  std::vector<Contradiction> found;
  std::vector<std::size_t> contradicted(count, 0);
  std::size_t exact = 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_exact(anchors.pairs[i])) continue;
    ++exact;
    for (std::size_t j = i + 1; j < count; ++j) {
      if (!is_exact(anchors.pairs[j])) continue;
      const auto a = static_cast<Eigen::Index>(i), b = static_cast<Eigen::Index>(j);
      const double apart = size * (sources.col(b) - sources.col(a)).norm();
      const double on_target = (targets.col(b) - targets.col(a)).norm();
      double difference = 0;
      if (excess(on_target, apart) > 0) difference = excess(on_target, size * along_source(a, b));
      if (excess(apart, on_target) > 0) difference = excess(apart, along_target(a, b));
      if (!(difference > 0)) continue;
      found.push_back({i, j, difference});
      ++contradicted[i];
      ++contradicted[j];
    }
  }
  const auto is_astray = [&](std::size_t i) { return 2 * contradicted[i] >= exact; };
  for (const Contradiction& pair : found) {
    if (is_astray(pair.first) || is_astray(pair.second)) continue;
    sigmas[pair.first] = std::max(sigmas[pair.first], pair.difference / 2);
    sigmas[pair.second] = std::max(sigmas[pair.second], pair.difference / 2);
  }
  return sigmas;
}

void let_contradicting_share(EstimatedAnchors& estimated, std::size_t given, const TriangleMesh& source,
                             const TriangleMesh& target, double max_stretch) {
  const auto kept = static_cast<std::size_t>(
      std::lower_bound(estimated.kept.begin(), estimated.kept.end(), given) - estimated.kept.begin());
  const std::vector<double> sigmas =
      sigmas_within_stretch(estimated.anchors, kept, source, target, max_stretch);
  for (std::size_t k = 0; k < kept; ++k) {
    if (!(sigmas[k] > 0)) continue;
    estimated.anchors.pairs[k].sigma = sigmas[k];
    estimated.sigmas[estimated.kept[k]] = sigmas[k];
    estimated.accuracy.given_way.push_back({estimated.kept[k], sigmas[k]});
  }
}

}  // namespace bespoke
