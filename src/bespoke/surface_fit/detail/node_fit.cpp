#include "bespoke/surface_fit/detail/node_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/rigid/nearest_rotation.h"
#include "bespoke/surface_fit/detail/block_system.h"
#include "bespoke/surface_fit/detail/deformation_nodes.h"
#include "bespoke/surface_fit/detail/informative_areas.h"

namespace bespoke {
namespace {

struct Level {
  int nodes;  // aimed at, over the whole surface
  int iterations;
  std::size_t samples, back_samples;  // pairs looked for, source to target and back
};
constexpr std::array levels = {Level{400, 10, 5000, 2000}, Level{2500, 6, 8000, 5000}};
constexpr double coarsest_smoothing = 0.5, finest_smoothing = 0.01;  // of the diagonal
constexpr double shape_share = 0.1;  // of the smoothing length: where local similarity begins to count
constexpr int boundary_start = 4;    // iterations: anchors and surfaces come first
constexpr double min_cosine = 0.3;
constexpr double max_distance = 0.1;  // of the diagonal: farther points are no counterparts
// Of the diagonal: of points about as near the one that faces alike is the counterpart, so that bulges find
// each other.
constexpr double normal_length = 0.02;
constexpr double outlier_medians = 4;  // residuals beyond lose their weight
constexpr double anchor_growth =
    2;  // weight of all exact anchors after the first iteration; the surface has 1
constexpr double back_share = 0.5;  // weight of target-to-source pairs
constexpr std::size_t grain = 128;

/// A vertex should lie in the plane through `point`.
struct PlaneObservation {
  int vertex = 0;
  Vector3 point, normal;
  double weight = 0;
};

/// A point of the surface as a combination of nodes.
using NodeWeights = std::vector<std::pair<int, double>>;

class LevelFit {
 public:
  LevelFit(const NodeFitInput& input, const Level& level, const Points& vertices,
           const Eigen::VectorXd& areas, const std::vector<SurfacePoint>& anchor_feet)
      : input_(input),
        total_area_(areas.sum()),
        nodes_(make_deformation_nodes(input.rest, spacing(total_area_, level.nodes))),
        anchors_(anchor_combinations(anchor_feet)),
        system_(adjacency()),
        displacements_(starting_displacements(vertices)) {}

  /// Solves for the nodes with the pairs found at `vertices`; 3×n, where the vertices go.
  Points step(const Points& vertices, const std::vector<PlaneObservation>& planes,
              const std::vector<BoundaryMatch>& boundary, double smoothing, double anchor_weight) {
    system_.set_zero();
    add_planes(vertices, planes);
    add_boundary(boundary);
    add_anchors(anchor_weight);
    add_bending(std::pow(smoothing / nodes_.spacing, 4));
    add_local_similarity(std::pow(shape_share * smoothing / nodes_.spacing, 2));
    displacements_ = system_.solve();
    Points moved = input_.rest.vertices;
    parallel_for(static_cast<std::size_t>(moved.cols()), grain, [&](std::size_t begin, std::size_t end) {
      for (auto i = static_cast<Eigen::Index>(begin); i < static_cast<Eigen::Index>(end); ++i)
        moved.col(i) += nodes_.displacement(displacements_, i);
    });
    return moved;
  }

 private:
  static double spacing(double area, int count) {
    constexpr double packing = 0.75;  // of greedy thinning: nodes × spacing² / area
    return std::sqrt(area / count / packing);
  }

  /// In one buffer, valid until the next call: this is asked for every pair.
  const NodeWeights& vertex_combination(int vertex) const {
    vertex_combination_.clear();
    for (int k = 0; k < DeformationNodes::per_vertex; ++k)
      if (nodes_.vertex_weights(k, vertex) != 0)
        vertex_combination_.emplace_back(nodes_.vertex_nodes(k, vertex), nodes_.vertex_weights(k, vertex));
    return vertex_combination_;
  }

  std::vector<NodeWeights> anchor_combinations(const std::vector<SurfacePoint>& feet) const {
    std::vector<NodeWeights> combinations;
    for (const SurfacePoint& foot : feet) {
      NodeWeights all;
      for (int corner = 0; corner < 3; ++corner)
        for (const auto& [node, weight] : vertex_combination(input_.rest.faces(corner, foot.face)))
          all.emplace_back(node, foot.barycentric[corner] * weight);
      std::sort(all.begin(), all.end());
      NodeWeights merged;
      for (const auto& [node, weight] : all) {
        if (!merged.empty() && merged.back().first == node)
          merged.back().second += weight;
        else
          merged.emplace_back(node, weight);
      }
      combinations.push_back(std::move(merged));
    }
    return combinations;
  }

  std::vector<std::vector<int>> adjacency() const {
    std::vector<std::vector<int>> adjacent(static_cast<std::size_t>(nodes_.size()));
    const auto tie = [&](const std::vector<int>& ids) {
      for (const int a : ids) adjacent[a].insert(adjacent[a].end(), ids.begin(), ids.end());
    };
    const auto tidy = [](std::vector<int>& list) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    };
    for (int node = 0; node < nodes_.size(); ++node) {
      std::vector<int> stencil = nodes_.neighbours[node];
      stencil.push_back(node);
      tie(stencil);
    }
    for (const NodeWeights& anchor : anchors_) {
      std::vector<int> ids;
      for (const auto& entry : anchor) ids.push_back(entry.first);
      tie(ids);
    }
    std::vector<std::size_t> limit(adjacent.size(), 4096);  // keeps the lists of large meshes short
    for (Eigen::Index vertex = 0; vertex < nodes_.vertex_nodes.cols(); ++vertex)
      for (const NodeWeights& used = vertex_combination(static_cast<int>(vertex));
           const auto& [a, weight_a] : used) {
        for (const auto& [b, weight_b] : used) adjacent[a].push_back(b);
        if (adjacent[a].size() < limit[a]) continue;
        tidy(adjacent[a]);
        limit[a] = std::max<std::size_t>(4096, 2 * adjacent[a].size());
      }
    return adjacent;
  }

  /// Where the coarser level left the vertices, least squares over the vertices near each node.
  Points starting_displacements(const Points& vertices) const {
    Points sum = Points::Zero(3, nodes_.size());
    Eigen::VectorXd total = Eigen::VectorXd::Constant(nodes_.size(), 1e-300);
    for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
      const double weight = nodes_.vertex_weights(0, i);
      sum.col(nodes_.vertex_nodes(0, i)) += weight * (vertices.col(i) - input_.rest.vertices.col(i));
      total[nodes_.vertex_nodes(0, i)] += weight;
    }
    return sum * total.cwiseInverse().asDiagonal();
  }

  /// |form^(1/2) (rest + displacement − goal)|² at a combination of nodes.
  void add_quadratic(const NodeWeights& combination, const Matrix3& form, const Vector3& goal_displacement) {
    const Vector3 pull = form * goal_displacement;
    for (const auto& [a, weight_a] : combination) {
      system_.add_right_side(a, weight_a * pull);
      for (const auto& [b, weight_b] : combination)
        if (a >= b) system_.add(a, b, (weight_a * weight_b) * form);
    }
  }

  void add_planes(const Points& vertices, const std::vector<PlaneObservation>& planes) {
    std::vector<double> distances;
    for (const PlaneObservation& plane : planes)
      distances.push_back((plane.point - vertices.col(plane.vertex)).norm());
    if (distances.empty()) return;
    std::vector<double> sorted = distances;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                     sorted.end());
    const double scale = outlier_medians * sorted[sorted.size() / 2] + 1e-4 * input_.diagonal;
    for (std::size_t k = 0; k < planes.size(); ++k) {
      const PlaneObservation& plane = planes[k];
      const double outlier = distances[k] / scale;
      const double weight = plane.weight / total_area_ / (1 + outlier * outlier);
      add_quadratic(vertex_combination(plane.vertex), weight * plane.normal * plane.normal.transpose(),
                    plane.point - input_.rest.vertices.col(plane.vertex));
    }
  }

  void add_boundary(const std::vector<BoundaryMatch>& boundary) {
    for (const BoundaryMatch& match : boundary) {
      // Like a strip of surface, one node spacing wide; free to slide along the cut.
      const double weight = match.length * nodes_.spacing / total_area_;
      add_quadratic(vertex_combination(match.vertex),
                    weight * (Matrix3::Identity() - match.tangent * match.tangent.transpose()),
                    match.point - input_.rest.vertices.col(match.vertex));
    }
  }

  void add_anchors(double exact_weight) {
    for (std::size_t k = 0; k < anchors_.size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const double own = input_.anchor_weights[column];
      const double weight = std::isinf(own) ? exact_weight / double(anchors_.size()) : own / 100;
      add_quadratic(anchors_[k], weight * Matrix3::Identity(),
                    input_.anchor_targets.col(column) - input_.anchor_sources.col(column));
    }
  }

  void add_bending(double weight) {
    const std::vector<BendingStencil> stencils = bending_stencils(nodes_, nodes_.rest + displacements_);
    for (int node = 0; node < nodes_.size(); ++node) {
      const BendingStencil& stencil = stencils[node];
      const double share = weight * nodes_.areas[node];
      for (std::size_t a = 0; a < stencil.ids.size(); ++a)
        for (std::size_t b = 0; b < stencil.ids.size(); ++b)
          system_.add(stencil.ids[a], stencil.ids[b],
                      share * stencil.quadratic(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) *
                          Matrix3::Identity());
      system_.add(node, node, 1e-9 * Matrix3::Identity());  // nothing may float freely
    }
  }

  /// Edges between nodes should be those of the rest, turned and scaled as around each node now.
  void add_local_similarity(double weight) {
    for (int node = 0; node < nodes_.size(); ++node) {
      Matrix3 covariance = Matrix3::Zero();
      double spread = 0;
      for (const int other : nodes_.neighbours[node]) {
        const Vector3 edge = nodes_.rest.col(other) - nodes_.rest.col(node);
        const Vector3 now = edge + displacements_.col(other) - displacements_.col(node);
        covariance += now * edge.transpose();
        spread += edge.squaredNorm();
      }
      if (!(spread > 0)) continue;
      const Matrix3 rotation = nearest_rotation(covariance).rotation;
      const Matrix3 similarity = ((rotation.transpose() * covariance).trace() / spread) * rotation;
      const double share = weight * nodes_.areas[node] / double(nodes_.neighbours[node].size());
      const Matrix3 form = share * Matrix3::Identity();
      for (const int other : nodes_.neighbours[node]) {
        const Vector3 edge = nodes_.rest.col(other) - nodes_.rest.col(node);
        const Vector3 pull = share * (similarity * edge - edge);
        system_.add(node, node, form);
        system_.add(other, other, form);
        system_.add(std::max(node, other), std::min(node, other), -form);
        system_.add_right_side(other, pull);
        system_.add_right_side(node, -pull);
      }
    }
  }

  mutable NodeWeights vertex_combination_;
  const NodeFitInput& input_;
  double total_area_;  // mesh units squared
  DeformationNodes nodes_;
  std::vector<NodeWeights> anchors_;
  BlockSystem system_;
  Points displacements_;
};

MatchLimits match_limits(double diagonal) {
  return {min_cosine, max_distance * diagonal, normal_length * diagonal};
}

void keep_found(std::vector<PlaneObservation>& planes) {
  std::erase_if(planes, [](const PlaneObservation& plane) { return !(plane.weight > 0); });
}

std::vector<PlaneObservation> source_to_target(const NodeFitInput& input, const TargetSurface& surface,
                                               const Eigen::VectorXd& areas, std::size_t samples) {
  const Points& points = surface.mesh().vertices;
  const std::size_t count = static_cast<std::size_t>(points.cols());
  const std::size_t stride = (count + samples - 1) / samples;
  const MatchLimits limits = match_limits(input.diagonal);
  std::vector<PlaneObservation> planes((count + stride - 1) / stride);
  parallel_for(planes.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k * stride);
      const auto found = input.target.match(points.col(i), surface.normals().col(i), limits);
      if (!found) continue;
      planes[k] = {static_cast<int>(i), found->point, found->halfway,
                   areas[i] * double(stride) * found->agreement * found->agreement};
    }
  });
  keep_found(planes);
  return planes;
}

/// What the target's points find on the moved source, as pulls on the nearest corner of the face found.
std::vector<PlaneObservation> target_to_source(const NodeFitInput& input, const TargetSurface& surface,
                                               const Eigen::VectorXd& areas, std::size_t samples) {
  const Points& points = input.target.mesh().vertices;
  const MatchLimits limits = match_limits(input.diagonal);
  const std::size_t count = static_cast<std::size_t>(points.cols());
  const std::size_t stride = (count + samples - 1) / samples;
  std::vector<PlaneObservation> planes((count + stride - 1) / stride);
  parallel_for(planes.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k * stride);
      const Vector3 normal = input.target.normals().col(i);
      const auto found = surface.match(points.col(i), normal, limits);
      if (!found) continue;
      int corner = 0;
      found->barycentric.maxCoeff(&corner);
      const int vertex = surface.mesh().faces(corner, found->face);
      planes[k] = {vertex, points.col(i) + surface.mesh().vertices.col(vertex) - found->point, found->halfway,
                   back_share * areas[i] * double(stride) * found->agreement * found->agreement};
    }
  });
  keep_found(planes);
  return planes;
}

}  // namespace

NodeFit fit_nodes(const NodeFitInput& input, const Progress& progress) {
  const TargetSurface rest(input.rest);
  const Eigen::VectorXd areas = informative_areas(rest, input.diagonal);
  const Eigen::VectorXd target_areas = informative_areas(input.target, input.diagonal);
  std::vector<SurfacePoint> feet;
  for (const auto& anchor : input.anchor_sources.colwise()) feet.push_back(rest.closest(anchor));
  BoundaryMatcher boundaries(rest, input.anchor_sources, input.target, input.boundaries);

  int total = 0;
  for (const Level& level : levels) total += level.iterations;
  NodeFit result;
  TriangleMesh moved = input.rest;
  for (const Level& level : levels) {
    if (result.iterations == levels.front().iterations) result.coarse_vertices = moved.vertices;
    LevelFit fit(input, level, moved.vertices, areas, feet);
    for (int iteration = 0; iteration < level.iterations; ++iteration, ++result.iterations) {
      progress.step("surface-fit", static_cast<std::size_t>(result.iterations),
                    static_cast<std::size_t>(total));
      std::vector<PlaneObservation> planes;
      // Before the anchors are met, closest points mislead.
      if (result.iterations > 0 || feet.empty()) {
        const TargetSurface surface = rest.moved(moved.vertices);
        planes = source_to_target(input, surface, areas, level.samples);
        const auto back = target_to_source(input, surface, target_areas, level.back_samples);
        planes.insert(planes.end(), back.begin(), back.end());
      }
      if (result.iterations == boundary_start) boundaries.decide(moved.vertices);
      const double progress_share = double(result.iterations) / (total - 1);
      const double smoothing = coarsest_smoothing *
                               std::pow(finest_smoothing / coarsest_smoothing, progress_share) *
                               input.diagonal;
      moved.vertices = fit.step(moved.vertices, planes, boundaries.match(moved.vertices), smoothing,
                                anchor_growth * (iteration + 1));
    }
  }
  result.anchor_sources = input.anchor_sources;
  for (std::size_t k = 0; k < feet.size(); ++k)
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = input.rest.faces(corner, feet[k].face);
      result.anchor_sources.col(static_cast<Eigen::Index>(k)) +=
          feet[k].barycentric[corner] * (moved.vertices.col(vertex) - input.rest.vertices.col(vertex));
    }
  result.vertices = std::move(moved.vertices);
  result.matched_boundaries = boundaries.matched_boundaries();
  return result;
}

}  // namespace bespoke
