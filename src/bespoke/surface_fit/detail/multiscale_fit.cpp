#include "bespoke/surface_fit/detail/multiscale_fit.h"

#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/edge_refinement.h"
#include "bespoke/parallel.h"
#include "bespoke/surface_fit/detail/detail_layers.h"
#include "bespoke/surface_fit/detail/node_fit.h"
#include "bespoke/surface_fit/detail/similarity_fit.h"
#include "bespoke/surface_fit/detail/turned_faces.h"

namespace bespoke {
namespace {

constexpr double similarity_tolerance = 5e-4;  // of the diagonal: remeshing noise of a faithful copy
constexpr double edges_per_area = 1125;  // an edge longer than √(area / this) is halved: about a node spacing
constexpr std::size_t grain = 256;

/// 1 where a vertex has a counterpart at its place that faces the same way, 0 where it has none.
std::vector<double> confidences(const TriangleMesh& fitted, const TargetSurface& target, double diagonal) {
  constexpr double near = 0.002;  // of the diagonal: the distance at which confidence falls to 1/e
  std::vector<double> all(static_cast<std::size_t>(fitted.vertices.cols()), 0.0);
  const Points normals = vertex_normals(fitted);
  parallel_for(all.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      const auto found = target.match(fitted.vertices.col(i), normals.col(i), {0, 0.01 * diagonal});
      if (!found) continue;
      const double offset = (found->point - fitted.vertices.col(i)).norm() / (near * diagonal);
      all[k] = found->agreement * std::exp(-offset * offset);
    }
  });
  return all;
}

/// The columns whose anchors are exact.
std::vector<Eigen::Index> exact_anchors(const Eigen::VectorXd& weights) {
  std::vector<Eigen::Index> exact;
  for (Eigen::Index k = 0; k < weights.size(); ++k)
    if (std::isinf(weights[k])) exact.push_back(k);
  return exact;
}

/// Moves points (3×k) on or near the surface as the surface moves under them.
void carry_along(const TriangleMesh& surface, const Points& moved_vertices, Points& points) {
  const ClosestPointTree tree(surface);
  for (auto&& point : points.colwise()) {
    const SurfacePoint foot = *tree.closest(point);
    for (int k = 0; k < 3; ++k) {
      const int vertex = surface.faces(k, foot.face);
      point += foot.barycentric[k] * (moved_vertices.col(vertex) - surface.vertices.col(vertex));
    }
  }
}

double largest_distance(const Points& a, const Points& b) {
  return a.cols() == 0 ? 0 : std::sqrt((a - b).colwise().squaredNorm().maxCoeff());
}

}  // namespace

SurfaceFit fit_surface_multiscale(const SurfaceFitInput& input, const SurfaceFitOptions& options,
                                  const Progress& progress) {
  progress.check();
  const auto start = std::chrono::steady_clock::now();
  const Eigen::Index count = input.source.vertices.cols();
  const double area = vertex_areas(input.source).sum();
  if (!(area > 0)) throw InvalidInput("the source of the surface fitting has no area");
  RefinedMesh refined = refine_long_edges(input.source, std::sqrt(area / edges_per_area));
  TriangleMesh& surface = refined.mesh;
  const TargetSurface target(input.target);

  const Similarity of_anchors =
      align_similarly(input.source.vertices, input.warped_vertices, Eigen::VectorXd::Ones(count));
  const double source_diagonal = diagonal(input.source.vertices);
  const SimilarityFit refined_similarity =
      fit_similarity(surface, target, of_anchors, similarity_tolerance * of_anchors.scale * source_diagonal);

  const std::vector<Eigen::Index> exact = exact_anchors(input.anchor_weights);
  const Points exact_targets = input.anchor_targets(Eigen::all, exact);
  const Points aligned_exact =
      refined_similarity.target_from_source * Points(input.anchor_sources(Eigen::all, exact));
  const bool similarity_suffices =
      refined_similarity.suffices && largest_distance(aligned_exact, exact_targets) <=
                                         2 * similarity_tolerance * of_anchors.scale * source_diagonal;
  const Similarity aligned = similarity_suffices ? refined_similarity.target_from_source : of_anchors;
  const double scaled_diagonal = aligned.scale * source_diagonal;
  surface.vertices = aligned * surface.vertices;
  Points anchors = aligned * input.anchor_sources;

  SurfaceFit fit;
  fit.summary.similarity_suffices = similarity_suffices;
  fit.summary.before = distances(target, input.warped_vertices);
  Points exact_sources = anchors(Eigen::all, exact);
  if (!similarity_suffices) {
    const NodeFit nodes = fit_nodes({surface, target, anchors, input.anchor_targets, input.anchor_weights,
                                     scaled_diagonal, options.boundaries},
                                    progress);
    surface.vertices = nodes.vertices;
    exact_sources = nodes.anchor_sources(Eigen::all, exact);
    const DetailFit details =
        fit_details({surface, target, exact_sources, exact_targets, scaled_diagonal}, progress);
    const MendedSurface mended = mend_turned_faces({nodes.coarse_vertices, surface.faces}, details.vertices);
    exact_sources = details.anchor_sources;
    if (mended.mended_vertices > 0)
      carry_along({details.vertices, surface.faces}, mended.vertices, exact_sources);
    surface.vertices = mended.vertices;
    fit.summary.mended_vertices = mended.mended_vertices;
    fit.summary.iterations = nodes.iterations + details.layers;
    fit.summary.matched_boundaries = nodes.matched_boundaries;
    fit.summary.stop_reason = details.last_step <= options.epsilon * scaled_diagonal
                                  ? StopReason::converged
                                  : StopReason::iteration_cap;
  } else {
    fit.summary.stop_reason = StopReason::converged;
  }
  surface.vertices = meet_anchors({surface, target, exact_sources, exact_targets, scaled_diagonal}).vertices;

  fit.vertices = surface.vertices.leftCols(count);
  fit.summary.after = distances(target, fit.vertices);
  fit.confidence = confidences({fit.vertices, input.source.faces}, target, scaled_diagonal);
  for (const double confidence : fit.confidence) fit.summary.unmatched_vertices += confidence > 0 ? 0 : 1;
  fit.summary.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return fit;
}

}  // namespace bespoke
