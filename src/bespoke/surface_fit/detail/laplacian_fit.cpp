#include "bespoke/surface_fit/detail/laplacian_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"
#include "bespoke/surface_fit/detail/displacement_smoother.h"
#include "bespoke/surface_fit/matching/target_surface.h"

namespace bespoke {
namespace {

/// Anchors count only where both ends lie on their surfaces to this fraction of the source's bounding-box
/// diagonal, as many times as large on the target as the target is: farther off, the surface point beneath
/// them is not what the user paired.
constexpr double on_surface = 1e-3;

/// s of Eq. 11. With scaled_stiffness s grows with the vertices: displacements then spread over some 0.08 of
/// the square root of the surface's area (√s edges). 1 at least, the printed equation.
double stiffness_of(const SurfaceFitOptions& options, Eigen::Index vertices) {
  constexpr double printed = 1, per_vertex = 0.005;
  if (options.stiffness) return *options.stiffness;
  if (!options.laplacian.scaled_stiffness) return printed;
  return std::max(printed, per_vertex * static_cast<double>(vertices));
}

/// An anchor that must be met outweighs by a thousand all that the six neighbours of a usual vertex can hold
/// against it.
double exact_anchor_weight(double stiffness) { return 1e3 * (1 + 6 * stiffness); }

Vector3 at_anchor(const Points& values, const DisplacementAnchor& anchor) {
  return values.col(anchor.vertices[0]) * anchor.barycentric[0] +
         values.col(anchor.vertices[1]) * anchor.barycentric[1] +
         values.col(anchor.vertices[2]) * anchor.barycentric[2];
}

/// What every vertex of one surface finds on another.
struct Correspondence {
  Points points;              // 3×n; the vertex's own position where it found nothing
  std::vector<char> matched;  // n; 1 where `points` holds a compatible point
  std::size_t unmatched = 0;  // vertices without one
};

Correspondence closest_compatible_points(const TriangleMesh& moving, const TargetSurface& target,
                                         const LaplacianAdditions& additions) {
  const auto count = static_cast<std::size_t>(moving.vertices.cols());
  const Points normals = vertex_normals(moving);
  const MatchLimits limits{0, std::numeric_limits<double>::infinity(), 0, !additions.refuse_boundary};
  Correspondence result{moving.vertices, std::vector<char>(count, 0), 0};
  constexpr std::size_t grain = 64;
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const auto found = target.match(moving.vertices.col(column), normals.col(column), limits);
      if (!found) continue;
      result.points.col(column) = found->point;
      result.matched[i] = 1;
    }
  });
  result.unmatched = static_cast<std::size_t>(std::count(result.matched.begin(), result.matched.end(), 0));
  return result;
}

/// An anchor that lies on both surfaces, and where it shall go.
struct SnappedAnchors {
  std::vector<DisplacementAnchor> places;
  Points targets;           // 3×k
  std::vector<char> exact;  // k
};

SnappedAnchors anchors_on_surfaces(const SurfaceFitInput& input, double stiffness) {
  const double heaviest = exact_anchor_weight(stiffness);
  const ClosestPointTree source(input.source);
  const ClosestPointTree target(input.target);
  ClosestPointQuery near_source, near_target;
  near_source.max_distance = on_surface * diagonal(input.source.vertices);
  near_target.max_distance = growth(input.source, input.warped_vertices) * near_source.max_distance;
  SnappedAnchors result;
  std::vector<Vector3> targets;
  for (Eigen::Index k = 0; k < input.anchor_sources.cols(); ++k) {
    const auto on_source = source.closest(input.anchor_sources.col(k), near_source);
    if (!on_source || !target.closest(input.anchor_targets.col(k), near_target)) continue;
    result.places.push_back({input.source.faces.col(on_source->face), on_source->barycentric,
                             std::min(input.anchor_weights[k], heaviest)});
    result.exact.push_back(input.anchor_weights[k] >= heaviest);
    targets.push_back(input.anchor_targets.col(k));
  }
  result.targets.resize(3, static_cast<Eigen::Index>(targets.size()));
  for (std::size_t k = 0; k < targets.size(); ++k)
    result.targets.col(static_cast<Eigen::Index>(k)) = targets[k];
  return result;
}

Points anchor_wishes(const SnappedAnchors& anchors, const Points& vertices) {
  Points wished = anchors.targets;
  for (Eigen::Index k = 0; k < wished.cols(); ++k)
    wished.col(k) -= at_anchor(vertices, anchors.places[static_cast<std::size_t>(k)]);
  return wished;
}

double root_mean_square(const Points& columns) {
  return columns.cols() == 0 ? 0 : columns.norm() / std::sqrt(static_cast<double>(columns.cols()));
}

struct Snapped {
  TriangleMesh mesh;
  std::vector<char> at_anchor;  // n; 1 for a vertex at an exact anchor
};

/// Matched vertices on their counterparts, exact anchors on theirs.
Snapped snap(const Correspondence& found, const SnappedAnchors& anchors, const TriangleMesh& smooth) {
  constexpr double at_vertex = 1 - 1e-6;
  Snapped result{smooth, std::vector<char>(found.matched.size(), 0)};
  for (Eigen::Index i = 0; i < found.points.cols(); ++i)
    if (found.matched[static_cast<std::size_t>(i)]) result.mesh.vertices.col(i) = found.points.col(i);
  for (std::size_t k = 0; k < anchors.places.size(); ++k) {
    const DisplacementAnchor& place = anchors.places[k];
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = place.vertices[corner];
      if (!anchors.exact[k] || !(place.barycentric[corner] > at_vertex)) continue;
      result.mesh.vertices.col(vertex) = anchors.targets.col(static_cast<Eigen::Index>(k));
      result.at_anchor[static_cast<std::size_t>(vertex)] = 1;
    }
  }
  return result;
}

/// Resets vertices whose snap flipped a face to where the smooth displacements brought them.
void undo_turning_snaps(const TriangleMesh& smooth, Snapped& snapped) {
  // Resetting a vertex can flip a neighbouring face; few rounds are enough.
  constexpr int max_rounds = 20;
  const Points smooth_normals = face_normals(smooth);
  Points& vertices = snapped.mesh.vertices;
  bool any_reset = true;
  for (int round = 0; round < max_rounds && any_reset; ++round) {
    const Points normals = face_normals(snapped.mesh);
    any_reset = false;
    for (Eigen::Index face = 0; face < normals.cols(); ++face) {
      if (normals.col(face).dot(smooth_normals.col(face)) > 0) continue;
      for (const int vertex : smooth.faces.col(face)) {
        if (snapped.at_anchor[static_cast<std::size_t>(vertex)] ||
            vertices.col(vertex) == smooth.vertices.col(vertex))
          continue;
        vertices.col(vertex) = smooth.vertices.col(vertex);
        any_reset = true;
      }
    }
  }
}

/// Whether ‖T⁰‖ has stopped falling. Real scans never come closer than their noise and their missing parts
/// let them.
class Stagnation {
 public:
  bool after(double distance) {
    constexpr double worthwhile = 0.99;
    constexpr int patience = 3;
    since_best_ = distance < worthwhile * best_ ? 0 : since_best_ + 1;
    if (since_best_ == 0) best_ = distance;
    return since_best_ >= patience;
  }

 private:
  double best_ = std::numeric_limits<double>::infinity();
  int since_best_ = 0;
};

}  // namespace

SurfaceFit fit_surface_laplacian(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                 const Progress& progress) {
  const Stopwatch watch;
  const LaplacianAdditions& additions = options.laplacian;
  const double epsilon =
      options.epsilon * growth(input.source, input.warped_vertices) * diagonal(input.source.vertices);
  SurfaceFit fit;
  SurfaceFitSummary& summary = fit.summary;
  summary.stiffness = stiffness_of(options, input.source.vertices.cols());
  const TargetSurface target(input.target);
  const SnappedAnchors anchors =
      additions.hold_anchors ? anchors_on_surfaces(input, summary.stiffness) : SnappedAnchors{};
  const DisplacementSmoother smoother(input.source, anchors.places, summary.stiffness);
  const std::vector<char> all_matched(static_cast<std::size_t>(input.source.vertices.cols()), 1);

  TriangleMesh moving{input.warped_vertices, input.source.faces};
  summary.before = distances(target, moving.vertices);
  summary.stop_reason = additions.stop_at_rest ? StopReason::iteration_cap : StopReason::unprinted_cap;
  Stagnation stagnation;
  for (summary.iterations = 0; summary.iterations < options.max_iterations; ++summary.iterations) {
    progress.step("surface-fit", static_cast<std::size_t>(summary.iterations),
                  static_cast<std::size_t>(options.max_iterations));
    const Correspondence found = closest_compatible_points(moving, target, additions);
    const Points wished = found.points - moving.vertices;  // T⁰; zero where nothing was found
    const double distance = root_mean_square(wished);
    if (!additions.stop_at_rest && distance <= epsilon) {
      summary.stop_reason = StopReason::converged;
      break;
    }
    if (additions.stop_at_rest && stagnation.after(distance)) {
      summary.stop_reason = StopReason::stagnated;
      break;
    }
    const Points step = smoother.solve(wished, additions.free_unmatched ? found.matched : all_matched,
                                       anchor_wishes(anchors, moving.vertices));
    moving.vertices += step;
    if (additions.stop_at_rest && root_mean_square(step) <= epsilon) {
      summary.stop_reason = StopReason::converged;
      break;
    }
  }
  const Correspondence found = closest_compatible_points(moving, target, additions);
  Snapped snapped = snap(found, anchors, moving);
  if (additions.undo_turning_snaps) undo_turning_snaps(moving, snapped);
  fit.vertices = std::move(snapped.mesh.vertices);
  fit.confidence.assign(found.matched.begin(), found.matched.end());
  summary.unmatched_vertices = found.unmatched;
  summary.after = distances(target, fit.vertices);
  summary.seconds = watch.seconds();
  return fit;
}

}  // namespace bespoke
