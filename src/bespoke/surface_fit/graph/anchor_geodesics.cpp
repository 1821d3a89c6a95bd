#include "bespoke/surface_fit/graph/anchor_geodesics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/spread_points.h"
#include "bespoke/mesh/surface_paths.h"
#include "bespoke/parallel.h"
#include "bespoke/topology/edge_refinement.h"

namespace bespoke {
namespace {

/// Vertices of the mesh that some anchor's paths reach, at most `max_count`.
std::vector<int> reached_vertices(const Eigen::MatrixXd& distances, int max_count) {
  std::vector<int> reached, chosen;
  for (Eigen::Index i = 0; i < distances.cols(); ++i)
    if (std::isfinite(distances.col(i).minCoeff())) reached.push_back(static_cast<int>(i));
  const std::size_t stride = (reached.size() + static_cast<std::size_t>(max_count) - 1) / max_count;
  for (std::size_t k = 0; k < reached.size(); k += stride) chosen.push_back(reached[k]);
  return chosen;
}

/// By squared distances of unit vectors: n, 0 to 2.
struct Misfits {
  Eigen::ArrayXd squared;
  Eigen::Index best = 0;

  /// place: m, inverse distances; weights: m; described: m×n.
  Misfits(const Eigen::VectorXd& place, const Eigen::VectorXd& weights, const Eigen::MatrixXd& described) {
    const Eigen::VectorXd weighted = weights.cwiseProduct(place);
    const double length = std::sqrt(weighted.dot(place));
    const Eigen::ArrayXd lengths = (described.cwiseAbs2().transpose() * weights).array().sqrt();
    // What no anchor with a weight reaches is like nothing.
    squared = 2 - 2 * (described.transpose() * weighted).array() /
                      (length * lengths).max(std::numeric_limits<double>::min());
    squared.minCoeff(&best);
  }
};

}  // namespace

AnchorGeodesics::Surface::Surface(const TriangleMesh& whole, const Points& anchors,
                                  const std::vector<int>& from, const GeodesicSettings& settings) {
  if (anchors.cols() == 0) return;
  // Counterparts are vertices, and paths go along edges.
  const double spacing = std::sqrt(vertex_areas(whole).sum() / settings.min_vertices);
  const TriangleMesh mesh = refine_long_edges(whole, spacing).mesh;
  const ClosestPointTree tree(mesh);
  std::vector<std::array<PathStart, 3>> feet;
  for (const auto& anchor : anchors.colwise()) feet.push_back(path_starts(mesh, *tree.closest(anchor)));
  const SurfaceGraph graph = edge_and_crossing_graph(mesh);
  Eigen::MatrixXd distances(static_cast<Eigen::Index>(from.size()), mesh.vertices.cols());
  parallel_for(from.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      distances.row(static_cast<Eigen::Index>(k)) =
          path_lengths(graph, feet[static_cast<std::size_t>(from[k])]).transpose();
  });
  at_anchors.resize(distances.rows(), anchors.cols());
  for (Eigen::Index k = 0; k < anchors.cols(); ++k) {
    at_anchors.col(k).setConstant(std::numeric_limits<double>::infinity());
    for (const PathStart& corner : feet[static_cast<std::size_t>(k)])
      at_anchors.col(k) =
          at_anchors.col(k).cwiseMin((distances.col(corner.vertex).array() + corner.distance).matrix());
  }
  const std::vector<int> vertices = reached_vertices(distances, settings.max_vertices);
  places = mesh.vertices(Eigen::all, vertices);
  described = distances(Eigen::all, vertices);
  double largest = 0;
  for (const double distance : described.reshaped())
    if (std::isfinite(distance)) largest = std::max(largest, distance);
  for (Eigen::MatrixXd* all : {&described, &at_anchors})
    *all = (all->array() + settings.softening * largest).inverse();
}

AnchorGeodesics::AnchorGeodesics(const TriangleMesh& source, const TriangleMesh& target,
                                 const Points& anchor_sources, const Points& anchor_targets,
                                 const GeodesicSettings& settings)
    : settings_(settings),
      anchor_targets_(anchor_targets),
      from_(spread_points(anchor_sources, static_cast<std::size_t>(settings.max_anchors))),
      source_(source, anchor_sources, from_, settings),
      target_(target, anchor_targets, from_, settings) {}

Eigen::VectorXd AnchorGeodesics::weights(const std::vector<double>& inliers) const {
  Eigen::VectorXd weights(static_cast<Eigen::Index>(from_.size()));
  for (std::size_t k = 0; k < from_.size(); ++k)
    weights[static_cast<Eigen::Index>(k)] = inliers[static_cast<std::size_t>(from_[k])];
  return weights;
}

GeodesicPairs AnchorGeodesics::pairs(const std::vector<double>& inliers) const {
  GeodesicPairs pairs{Points(3, 0), Points(3, 0)};
  const Eigen::VectorXd of_anchors = weights(inliers);
  if ((of_anchors.array() > 0.5).count() < settings_.min_anchors) return pairs;
  const Points &here = source_.places, &there = target_.places;
  const double max_return = settings_.max_return;
  const double elsewhere = settings_.elsewhere * diagonal(there);
  const auto counterpart = [&](Eigen::Index place) -> std::optional<Eigen::Index> {
    const Misfits found(source_.described.col(place), of_anchors, target_.described);
    const Misfits back(target_.described.col(found.best), of_anchors, source_.described);
    if ((here.col(back.best) - here.col(place)).norm() > max_return) return std::nullopt;
    double other = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < there.cols(); ++i)
      if (found.squared[i] < other && (there.col(i) - there.col(found.best)).norm() > elsewhere)
        other = found.squared[i];
    if (found.squared[found.best] > settings_.max_ratio * settings_.max_ratio * other) return std::nullopt;
    return found.best;
  };
  const std::vector<int> spread = spread_points(here, static_cast<std::size_t>(settings_.count));
  std::vector<std::optional<Eigen::Index>> found(spread.size());
  parallel_for(spread.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) found[k] = counterpart(spread[k]);
  });
  std::vector<Eigen::Index> from, to;
  for (std::size_t k = 0; k < spread.size(); ++k)
    if (found[k]) {
      from.push_back(spread[k]);
      to.push_back(*found[k]);
    }
  pairs.sources = here(Eigen::all, from);
  pairs.targets = there(Eigen::all, to);
  return pairs;
}

LeftOutAnchors AnchorGeodesics::left_out(const std::vector<double>& inliers) const {
  const Eigen::Index count = anchor_targets_.cols();
  LeftOutAnchors result{Eigen::VectorXd::Zero(count), Eigen::VectorXd(count)};
  parallel_for(static_cast<std::size_t>(count), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto at = static_cast<Eigen::Index>(k);
      Eigen::VectorXd of_others = weights(inliers);
      if (const auto own = std::find(from_.begin(), from_.end(), static_cast<int>(k)); own != from_.end())
        of_others[own - from_.begin()] = 0;
      const Eigen::VectorXd place = source_.at_anchors.col(at);
      const double squared = of_others.dot(place.cwiseAbs2());
      result.compliances[at] = squared > 0 ? 1 / squared : 1.0;
      if (!(squared > 0)) continue;  // alone on its component, where nothing contradicts it
      const Misfits found(place, of_others, target_.described);
      result.distances[at] = (target_.places.col(found.best) - anchor_targets_.col(at)).norm();
    }
  });
  return result;
}

}  // namespace bespoke
