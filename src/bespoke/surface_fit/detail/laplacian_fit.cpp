#include "bespoke/surface_fit/detail/laplacian_fit.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/parallel.h"
#include "bespoke/surface_fit/detail/target_surface.h"

namespace bespoke {
namespace {

constexpr std::size_t grain = 64;
using Triplet = Eigen::Triplet<double>;
using Columns = Eigen::Matrix<double, Eigen::Dynamic, 3>;  // n×3, the layout of the solver

/// Anchors count only where both ends lie on their surfaces to this fraction of the source's bounding-box
/// diagonal: farther off, the surface point beneath them is not what the user paired.
constexpr double on_surface = 1e-3;

/// s per vertex when the caller leaves it open: displacements then spread over some 0.08 of the square root
/// of the surface's area (√s edges). Measured on eight pairs of bodies, heads, a hand and a foot, of 4,514
/// to 14,062 vertices, where s from 1 to 300 was tried; 1 at least, the printed equation.
double default_stiffness(Eigen::Index vertices) {
  return std::max(1.0, 0.005 * static_cast<double>(vertices));
}

/// An anchor that must be met outweighs all that the six neighbours of a usual vertex can hold against it.
double exact_anchor_weight(double stiffness) { return 1e3 * (1 + 6 * stiffness); }

Eigen::SparseMatrix<double> umbrella_system(const TriangleMesh& mesh,
                                            const std::vector<DisplacementAnchor>& anchors,
                                            double stiffness) {
  const VertexAdjacency adjacency = vertex_adjacency(mesh);
  const auto count = static_cast<int>(mesh.vertices.cols());
  std::vector<Triplet> entries;
  entries.reserve(adjacency.neighbours.size() + static_cast<std::size_t>(count) + 9 * anchors.size());
  for (int i = 0; i < count; ++i) {
    const auto row = static_cast<std::size_t>(i);
    const int valence = adjacency.start[row + 1] - adjacency.start[row];
    entries.emplace_back(i, i, 1 + stiffness * valence);
    for (int k = adjacency.start[row]; k < adjacency.start[row + 1]; ++k)
      entries.emplace_back(i, adjacency.neighbours[static_cast<std::size_t>(k)], -stiffness);
  }
  for (const DisplacementAnchor& anchor : anchors)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        entries.emplace_back(anchor.vertices[i], anchor.vertices[j],
                             anchor.weight * anchor.barycentric[i] * anchor.barycentric[j]);
  Eigen::SparseMatrix<double> matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Vector3 at_anchor(const Points& values, const DisplacementAnchor& anchor) {
  return values.col(anchor.vertices[0]) * anchor.barycentric[0] +
         values.col(anchor.vertices[1]) * anchor.barycentric[1] +
         values.col(anchor.vertices[2]) * anchor.barycentric[2];
}

}  // namespace

DisplacementSmoother::DisplacementSmoother(const TriangleMesh& mesh,
                                           const std::vector<DisplacementAnchor>& anchors, double stiffness)
    : anchors_(anchors) {
  if (!(stiffness >= 0 && std::isfinite(stiffness)))
    throw InvalidInput("stiffness is " + std::to_string(stiffness) + ", but must be finite and at least 0");
  matrix_ = umbrella_system(mesh, anchors_, stiffness);
  factor_.compute(matrix_);
  if (factor_.info() != Eigen::Success)
    throw SolverError("the surface-fitting matrix of " + std::to_string(matrix_.rows()) +
                      " vertices could not be factored");
}

Points DisplacementSmoother::solve(const Points& wished, const std::vector<char>& matched,
                                   const Points& anchor_wished) const {
  Columns right = wished.transpose();
  Eigen::VectorXd missing = Eigen::VectorXd::Zero(right.rows());
  for (Eigen::Index i = 0; i < right.rows(); ++i)
    if (!matched[static_cast<std::size_t>(i)]) {
      right.row(i).setZero();
      missing[i] = 1;
    }
  for (std::size_t k = 0; k < anchors_.size(); ++k)
    for (int corner = 0; corner < 3; ++corner)
      right.row(anchors_[k].vertices[corner]) += anchors_[k].weight * anchors_[k].barycentric[corner] *
                                                 anchor_wished.col(static_cast<Eigen::Index>(k)).transpose();
  const Columns first = factor_.solve(right);
  if (!(missing.maxCoeff() > 0)) return first.transpose();

  // The matrix without the unmatched vertices' ones differs from the factored one in a few diagonal entries:
  // conjugate gradients preconditioned by the factor need few steps, and no new factorisation.
  constexpr int most_steps = 50;
  constexpr double relative_residual = 1e-5;
  const auto multiply = [&](const Columns& x) -> Columns { return matrix_ * x - missing.asDiagonal() * x; };
  Columns solution = first;
  Columns residual = right - multiply(solution);
  Columns preconditioned = factor_.solve(residual);
  Columns direction = preconditioned;
  Eigen::RowVector3d product = residual.cwiseProduct(preconditioned).colwise().sum();
  const Eigen::RowVector3d enough =
      relative_residual * relative_residual * right.cwiseProduct(first).colwise().sum();
  for (int step = 0; step < most_steps && (product.array() > enough.array()).any(); ++step) {
    const Columns image = multiply(direction);
    const Eigen::RowVector3d curvature = direction.cwiseProduct(image).colwise().sum();
    const Eigen::RowVector3d length =
        (curvature.array() > 0).select(product.array() / curvature.array(), 0.0).matrix();
    solution += direction * length.asDiagonal();
    residual -= image * length.asDiagonal();
    preconditioned = factor_.solve(residual);
    const Eigen::RowVector3d next = residual.cwiseProduct(preconditioned).colwise().sum();
    const Eigen::RowVector3d ratio =
        (product.array() > 0).select(next.array() / product.array(), 0.0).matrix();
    direction = preconditioned + direction * ratio.asDiagonal();
    product = next;
  }
  return solution.transpose();
}

namespace {

/// What every vertex of one surface finds on another.
struct Correspondence {
  Points points;              // 3×n; the vertex's own position where it found nothing
  std::vector<char> matched;  // n; 1 where `points` holds a compatible point
  std::size_t unmatched = 0;  // vertices without one
};

Correspondence closest_compatible_points(const TriangleMesh& moving, const TargetSurface& target) {
  const auto count = static_cast<std::size_t>(moving.vertices.cols());
  const Points normals = vertex_normals(moving);
  const MatchLimits limits{0, std::numeric_limits<double>::infinity()};
  Correspondence result{moving.vertices, std::vector<char>(count, 0), 0};
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
struct SurfaceAnchors {
  std::vector<DisplacementAnchor> places;
  Points targets;           // 3×k
  std::vector<char> exact;  // k
};

SurfaceAnchors anchors_on_surfaces(const SurfaceFitInput& input, double stiffness) {
  const double reach = on_surface * diagonal(input.source.vertices);
  const double heaviest = exact_anchor_weight(stiffness);
  const ClosestPointTree source(input.source);
  const ClosestPointTree target(input.target);
  ClosestPointQuery near;
  near.max_distance = reach;
  SurfaceAnchors result;
  std::vector<Vector3> targets;
  for (Eigen::Index k = 0; k < input.anchor_sources.cols(); ++k) {
    const auto on_source = source.closest(input.anchor_sources.col(k), near);
    if (!on_source || !target.closest(input.anchor_targets.col(k), near)) continue;
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

Points anchor_wishes(const SurfaceAnchors& anchors, const Points& vertices) {
  Points wished = anchors.targets;
  for (Eigen::Index k = 0; k < wished.cols(); ++k)
    wished.col(k) -= at_anchor(vertices, anchors.places[static_cast<std::size_t>(k)]);
  return wished;
}

double root_mean_square(const Points& columns) {
  return columns.cols() == 0 ? 0 : columns.norm() / std::sqrt(static_cast<double>(columns.cols()));
}

/// Matched vertices on their counterparts, exact anchors on theirs. A vertex whose snap would turn a face
/// over stays where the smooth displacements brought it.
Points snapped(const Correspondence& found, const SurfaceAnchors& anchors, const TriangleMesh& smooth) {
  TriangleMesh result = smooth;
  for (Eigen::Index i = 0; i < found.points.cols(); ++i)
    if (found.matched[static_cast<std::size_t>(i)]) result.vertices.col(i) = found.points.col(i);
  constexpr double at_vertex = 1 - 1e-6;
  std::vector<char> anchored(static_cast<std::size_t>(found.points.cols()), 0);
  for (std::size_t k = 0; k < anchors.places.size(); ++k) {
    const DisplacementAnchor& place = anchors.places[k];
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = place.vertices[corner];
      if (!anchors.exact[k] || !(place.barycentric[corner] > at_vertex)) continue;
      result.vertices.col(vertex) = anchors.targets.col(static_cast<Eigen::Index>(k));
      anchored[static_cast<std::size_t>(vertex)] = 1;
    }
  }
  // Taking a vertex back can turn a neighbouring face that was fine; few rounds settle that.
  constexpr int most_rounds = 20;
  const Points smooth_normals = face_normals(smooth);
  for (int round = 0; round < most_rounds; ++round) {
    const Points normals = face_normals(result);
    bool taken_back = false;
    for (Eigen::Index face = 0; face < normals.cols(); ++face) {
      if (normals.col(face).dot(smooth_normals.col(face)) > 0) continue;
      for (int corner = 0; corner < 3; ++corner) {
        const int vertex = smooth.faces(corner, face);
        if (anchored[static_cast<std::size_t>(vertex)] ||
            result.vertices.col(vertex) == smooth.vertices.col(vertex))
          continue;
        result.vertices.col(vertex) = smooth.vertices.col(vertex);
        taken_back = true;
      }
    }
    if (!taken_back) break;
  }
  return std::move(result.vertices);
}

}  // namespace

SurfaceFit fit_surface_laplacian(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                 const Progress& progress) {
  const auto start = std::chrono::steady_clock::now();
  const double source_diagonal = diagonal(input.source.vertices);
  const double stiffness = options.stiffness.value_or(default_stiffness(input.source.vertices.cols()));
  const TargetSurface target(input.target);
  const SurfaceAnchors anchors = anchors_on_surfaces(input, stiffness);
  const DisplacementSmoother smoother(input.source, anchors.places, stiffness);

  TriangleMesh moving{input.warped_vertices, input.source.faces};
  SurfaceFit fit;
  SurfaceFitSummary& summary = fit.summary;
  summary.before = distances(target, moving.vertices);
  double best_distance = std::numeric_limits<double>::infinity();
  int since_best = 0;
  for (summary.iterations = 0; summary.iterations < options.max_iterations; ++summary.iterations) {
    progress.step("surface-fit", static_cast<std::size_t>(summary.iterations),
                  static_cast<std::size_t>(options.max_iterations));
    const Correspondence found = closest_compatible_points(moving, target);
    const Points wished = found.points - moving.vertices;
    const double distance = root_mean_square(wished);
    // Real scans never come closer than their noise and their missing parts let them.
    constexpr double worthwhile = 0.99;
    constexpr int patience = 3;
    since_best = distance < worthwhile * best_distance ? 0 : since_best + 1;
    if (since_best == 0) best_distance = distance;
    if (since_best >= patience) {
      summary.stop_reason = StopReason::stagnated;
      break;
    }
    const Points step = smoother.solve(wished, found.matched, anchor_wishes(anchors, moving.vertices));
    moving.vertices += step;
    if (root_mean_square(step) <= options.epsilon * source_diagonal) {
      summary.stop_reason = StopReason::converged;
      break;
    }
  }
  const Correspondence found = closest_compatible_points(moving, target);
  moving.vertices = snapped(found, anchors, moving);
  fit.confidence.assign(found.matched.begin(), found.matched.end());
  summary.unmatched_vertices = found.unmatched;
  summary.after = distances(target, moving.vertices);
  fit.vertices = std::move(moving.vertices);
  summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return fit;
}

}  // namespace bespoke
