#include "bespoke/surface_fit/detail/deformation_graph_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/closest_point.h"
#include "bespoke/parallel.h"
#include "bespoke/stopwatch.h"
#include "bespoke/surface_fit/detail/anchor_meeting.h"
#include "bespoke/surface_fit/detail/detail_layers.h"
#include "bespoke/surface_fit/detail/misoriented_faces.h"
#include "bespoke/surface_fit/detail/unit_models.h"
#include "bespoke/surface_fit/graph/deformation_nodes.h"
#include "bespoke/surface_fit/graph/geodesic_pose.h"
#include "bespoke/surface_fit/graph/node_fit.h"
#include "bespoke/surface_fit/graph/similarity_fit.h"
#include "bespoke/surface_fit/matching/unmatched_cavities.h"
#include "bespoke/topology/edge_refinement.h"

namespace bespoke {
namespace {

/// Anchors that lie on the surface or near it.
struct SurfaceAnchors {
  Points sources, targets;  // 3×k
  Eigen::VectorXd weights, sigmas;
  std::vector<Eigen::Index> exact;  // columns of those with infinite weight and σ = 0
  std::vector<Eigen::Index> given;  // k: columns among all anchors of the fit
  std::vector<char> tested;         // k, or empty

  Points exact_sources() const { return sources(Eigen::all, exact); }
  Points exact_targets() const { return targets(Eigen::all, exact); }
};

/// Inaccurate targets without the part of their error that the surfaces show: as far from the target as
/// their anchors are from the source.
void register_by_similarity(const TriangleMesh& source, const TriangleMesh& target, SurfaceAnchors& anchors) {
  if (!(anchors.sigmas.array() > 0).any()) return;
  const ClosestPointTree source_surface(source), target_surface(target);
  for (Eigen::Index k = 0; k < anchors.sigmas.size(); ++k) {
    if (!(anchors.sigmas[k] > 0)) continue;
    const double wanted = source_surface.closest(anchors.sources.col(k))->squared_distance;
    const SurfacePoint foot = *target_surface.closest(anchors.targets.col(k));
    if (foot.squared_distance > wanted)
      anchors.targets.col(k) =
          foot.point + std::sqrt(wanted / foot.squared_distance) * (anchors.targets.col(k) - foot.point);
  }
}

SurfaceAnchors anchors_of(const SurfaceFitInput& input, const NodeFitSettings& settings) {
  const std::vector<Eigen::Index> near = anchors_near(input.source, input.anchor_sources, settings);
  const Eigen::VectorXd sigmas = input.anchor_sigmas.size() == 0
                                     ? Eigen::VectorXd::Zero(input.anchor_weights.size())
                                     : input.anchor_sigmas;
  SurfaceAnchors anchors{input.anchor_sources(Eigen::all, near),
                         input.anchor_targets(Eigen::all, near),
                         input.anchor_weights(near),
                         sigmas(near),
                         {},
                         near,
                         {}};
  if (!input.anchor_tested.empty())
    for (const Eigen::Index k : near)
      anchors.tested.push_back(input.anchor_tested[static_cast<std::size_t>(k)]);
  for (Eigen::Index k = 0; k < anchors.weights.size(); ++k) {
    if (anchors.sigmas[k] > 0)
      anchors.weights[k] = std::numeric_limits<double>::infinity();  // limited by σ instead
    else if (std::isinf(anchors.weights[k]))
      anchors.exact.push_back(k);
  }
  register_by_similarity(input.source, input.target, anchors);
  return anchors;
}

/// The source with halved long edges.
PatchedMesh refined_source(const SurfaceFitInput& input, double edges_per_area) {
  const double area = vertex_areas(input.source).sum();
  if (!(area > 0)) throw InvalidInput("the source of the surface fitting has no area");
  RefinedMesh refined = refine_long_edges(input.source, std::sqrt(area / edges_per_area));
  PatchedMesh result{std::move(refined.mesh), {}};
  if (input.source_patches.is_empty()) return result;
  for (const int face : refined.origins)
    result.patches.of_face.push_back(input.source_patches.of_face[static_cast<std::size_t>(face)]);
  return result;
}

/// 1 where a vertex has a counterpart at its place that faces the same way, 0 where it has none.
std::vector<double> confidences(const TriangleMesh& fitted, const FacePatches& patches,
                                const TargetSurface& target, const ConfidenceSettings& settings) {
  const std::vector<std::optional<int>> own = vertex_patches(fitted, patches);
  std::vector<double> all(static_cast<std::size_t>(fitted.vertices.cols()), 0.0);
  const Points normals = vertex_normals(fitted);
  constexpr std::size_t grain = 256;
  parallel_for(all.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      const auto i = static_cast<Eigen::Index>(k);
      MatchLimits limits{0, settings.reach};
      if (!own.empty()) limits.patch = own[k];
      const auto found = target.match(fitted.vertices.col(i), normals.col(i), limits);
      if (!found) continue;
      const double offset = (found->point - fitted.vertices.col(i)).norm() / settings.near;
      all[k] = found->agreement * std::exp(-offset * offset);
    }
  });
  return all;
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

/// Where one similarity brings the source, and whether that is all.
struct Alignment {
  Similarity target_from_source;
  bool suffices = false;
};

/// Of a surface that one similarity brings to the target: that of the exact anchors where they tell it more
/// accurately than the surfaces do, and agree with these.
Similarity more_accurate(const SimilarityFit& by_surfaces, const Points& surface, const Points& sources,
                         const Points& targets, double tolerance) {
  constexpr Eigen::Index min_anchors = 4;
  const auto count = static_cast<double>(sources.cols());
  if (sources.cols() < min_anchors) return by_surfaces.target_from_source;
  const Similarity by_anchors = align_similarly(sources, targets, Eigen::VectorXd::Ones(sources.cols()));
  const double standard_error = (by_anchors * sources - targets).norm() / count;
  // Anchors near a line leave a rotation open.
  const bool agree =
      largest_distance(by_anchors * surface, by_surfaces.target_from_source * surface) <= tolerance;
  return agree && standard_error < by_surfaces.standard_error ? by_anchors : by_surfaces.target_from_source;
}

/// The similarity nearest to the warp, refined on the surfaces or by exact anchors where one explains the
/// target.
Alignment align(const SurfaceFitInput& input, const TriangleMesh& surface, const TargetSurface& target,
                const SurfaceAnchors& anchors, const SimilaritySettings& settings) {
  const Similarity of_warp = similarity_of_warp(input);
  const SimilarityFit refined = fit_similarity(surface, target, of_warp, settings);
  const double tolerance = settings.anchor_tolerance * std::max(settings.tolerance, refined.residual);
  const Points sources = anchors.exact_sources(), targets = anchors.exact_targets();
  const bool suffices =
      refined.suffices && largest_distance(refined.target_from_source * sources, targets) <= tolerance;
  return {suffices ? more_accurate(refined, surface.vertices, sources, targets, tolerance) : of_warp,
          suffices};
}

/// What is deformed, all aligned with the target.
struct Scene {
  TriangleMesh surface;
  const TargetSurface& target;
  SurfaceAnchors& anchors;
  Points exact_sources;      // 3×k, carried with the surface
  Points exact_targets;      // 3×k
  FacePatches patches;       // of the surface
  std::vector<char> hidden;  // n: in a cavity that the target lacks
  Points coarse_vertices;    // 3×n: as the coarse deformation left the surface

  DetailInput details() const { return {surface, target, exact_sources, exact_targets, hidden, patches}; }
};

/// Vertices of the source that an excluded patch leaves without counterpart: those in one, and those that
/// found nothing where the target is nearest in one.
std::vector<int> excluded_vertices(const SurfaceFitInput& input, const SurfaceFit& fit) {
  std::vector<int> all;
  if (!input.source_patches.has_excluded() && !input.target_patches.has_excluded()) return all;
  const std::vector<std::optional<int>> own = vertex_patches(input.source, input.source_patches);
  const ClosestPointTree target(input.target);
  for (std::size_t i = 0; i < own.size(); ++i) {
    const auto face =
        static_cast<std::size_t>(target.closest(fit.vertices.col(static_cast<Eigen::Index>(i)))->face);
    const bool is_opposite =
        fit.confidence[i] == 0 && input.target_patches.of_face[face] == FacePatches::excluded;
    if (own[i] == FacePatches::excluded || is_opposite) all.push_back(static_cast<int>(i));
  }
  return all;
}

/// Of what is not excluded and not in a cavity that the target lacks, to what is not excluded.
void measure_distances(const SurfaceFitInput& input, const TargetSurface& target, SurfaceFit& fit) {
  const auto is_among = [](const std::vector<int>& ascending, int vertex) {
    return std::binary_search(ascending.begin(), ascending.end(), vertex);
  };
  std::vector<int> measured;
  for (int i = 0; i < input.source.vertices.cols(); ++i)
    if (!is_among(fit.summary.excluded_vertices, i) && !is_among(fit.summary.cavity_vertices, i))
      measured.push_back(i);
  fit.summary.before = distances(target, input.warped_vertices(Eigen::all, measured));
  fit.summary.after = distances(target, fit.vertices(Eigen::all, measured));
}

/// Accuracies that the pose takes the anchors for; a soft anchor's weight stands for one too.
Eigen::VectorXd pose_sigmas(const Scene& scene, const PoseSettings& settings) {
  return (settings.sigma_of_weight_one * scene.anchors.weights.cwiseSqrt().cwiseInverse())
      .cwiseMax(scene.anchors.sigmas);
}

/// Whether closest points cannot find what anchors tell: two at least, since one alone may be an outlier, are
/// farther from their targets than closest points reach.
bool are_out_of_reach(const Scene& scene, const Points& anchors, const std::vector<Eigen::Index>& outliers,
                      const DeformationGraphSettings& settings) {
  const double reach = settings.nodes.max_distance;
  Eigen::VectorXd distances = (anchors - scene.anchors.targets).colwise().norm();
  for (const Eigen::Index k : outliers) distances[k] = 0;
  return ((distances - settings.pose.anchor_reach * scene.anchors.sigmas).array() > reach).count() > 1;
}

struct Deforming {
  const SurfaceFitOptions& options;
  const DeformationGraphSettings& settings;
  const Progress& progress;
};

/// The nodes' fit, from the aligned source or from one that the anchors have bent: that where anchors are
/// far from their targets, or a part turns some way and the models keep their shape.
NodeFit fit_nodes(const Scene& scene, const Points& anchors, const Deforming& how,
                  SurfaceFitSummary& summary) {
  const DeformationGraphSettings& settings = how.settings;
  const Eigen::VectorXd sigmas = pose_sigmas(scene, settings.pose);
  const auto fitting = [&](const TriangleMesh& rest, const Points& carried_anchors,
                           const std::vector<char>& tested, bool is_posed) {
    return NodeFitting({rest, scene.surface.vertices, scene.target, carried_anchors, scene.anchors.targets,
                        scene.anchors.weights, how.options.boundaries, scene.anchors.sigmas, scene.patches,
                        is_posed, tested},
                       settings.nodes, how.progress);
  };
  std::optional<GeodesicPose> geodesic;
  const auto pose = [&]() -> const GeodesicPose& {
    if (!geodesic)
      geodesic.emplace(
          GeodesicPoseInput{scene.surface, scene.patches, scene.target.mesh(), anchors, scene.anchors.targets,
                            sigmas, scene.anchors.sigmas, scene.anchors.tested},
          settings.pose);
    return *geodesic;
  };
  const auto turn_degrees = [&] { return summary.anchor_turn_degrees = pose().turn_degrees(); };
  const bool is_posed = are_out_of_reach(scene, anchors, {}, settings) &&
                        are_out_of_reach(scene, anchors, pose().outliers(), settings);
  if (is_posed) {
    turn_degrees();
  } else {
    NodeFitting straight = fitting(scene.surface, anchors, scene.anchors.tested, false);
    if (!(straight.fit_coarse() > 1 && turn_degrees() > settings.pose.min_rigid_turn))
      return straight.fit_fine();
  }
  summary.posed_by_anchors = true;
  const AnchorPose by_anchors = pose().bent();
  const TriangleMesh bent{by_anchors.vertices, scene.surface.faces};
  NodeFitting posed = fitting(bent, by_anchors.anchor_sources, {}, true);
  posed.fit_coarse();
  NodeFit fit = posed.fit_fine();
  fit.tested_anchors = pose().has_tested();
  fit.outliers = pose().outliers();
  return fit;
}

/// Pose, nodes, layers of space, repair. Returns what the summary says of them.
SurfaceFitSummary deform(Scene& scene, const Points& aligned_anchors, const Deforming& how) {
  const auto& [options, settings, progress] = how;
  SurfaceFitSummary summary;
  const NodeFit nodes = fit_nodes(scene, aligned_anchors, how, summary);
  const Points shape = std::exchange(scene.surface.vertices, nodes.vertices);
  scene.hidden = nodes.hidden;
  std::erase_if(scene.anchors.exact, [&](Eigen::Index k) {
    return std::find(nodes.outliers.begin(), nodes.outliers.end(), k) != nodes.outliers.end();
  });
  summary.tested_anchors = nodes.tested_anchors;
  for (const Eigen::Index k : nodes.outliers)
    summary.outlier_anchors.push_back(
        static_cast<std::size_t>(scene.anchors.given[static_cast<std::size_t>(k)]));
  scene.exact_sources = nodes.anchor_sources(Eigen::all, scene.anchors.exact);
  scene.exact_targets = scene.anchors.exact_targets();
  const DetailFit details = fit_details(scene.details(), settings.details, progress);
  FaceRepairSettings face_repair = settings.face_repair;
  face_repair.max_stretch = options.max_stretch;
  const TriangleMesh coarse{nodes.coarse_vertices, scene.surface.faces};
  scene.coarse_vertices = nodes.coarse_vertices;
  RepairedSurface repaired = repair_misoriented_faces({shape, coarse, details.vertices}, face_repair);
  scene.exact_sources = details.anchor_sources;
  if (repaired.repaired_vertices > 0)
    carry_along({details.vertices, scene.surface.faces}, repaired.vertices, scene.exact_sources);
  const TriangleMesh rest{shape, scene.surface.faces};
  const RegisteredSurface registered{rest, repaired.vertices};
  scene.surface.vertices = carried_by_space(registered, nodes.unmatched, nodes.unmatched_cavities.contains,
                                            settings.nodes.unmatched_cavities);

  summary.repaired_vertices = repaired.repaired_vertices;
  summary.stretched_vertices = std::move(repaired.stretched_vertices);
  summary.iterations = nodes.iterations + details.layers;
  summary.rigidity = nodes.rigidity;
  summary.matched_boundaries = nodes.matched_boundaries;
  summary.stop_reason =
      details.last_step <= options.epsilon ? StopReason::converged : StopReason::iteration_cap;
  return summary;
}

}  // namespace

std::vector<Eigen::Index> anchors_near(const TriangleMesh& surface, const Points& anchors,
                                       const NodeFitSettings& settings) {
  ClosestPointQuery query;
  query.max_distance =
      node_spacing(vertex_areas(surface).sum(), settings.levels.back().nodes, settings.nodes);
  const ClosestPointTree tree(surface);
  std::vector<Eigen::Index> near;
  for (Eigen::Index k = 0; k < anchors.cols(); ++k)
    if (tree.closest(anchors.col(k), query)) near.push_back(k);
  return near;
}

SurfaceFit fit_surface_deformation_graph(const SurfaceFitInput& given, const SurfaceFitOptions& options,
                                         const Progress& progress) {
  progress.check();
  const Stopwatch watch;
  if (!(options.max_stretch > 1))
    throw InvalidInput("a largest stretch of " + std::to_string(options.max_stretch) +
                       "; it must be above 1");
  const UnitModels models(given);
  const SurfaceFitInput input = models.input();
  DeformationGraphSettings settings;
  if (!options.tell_rigidity) settings.nodes.shape.max_rigid = 1;
  PatchedMesh source = refined_source(input, settings.edges_per_area);
  const PatchedMesh attracting = without_excluded(input.target, input.target_patches);
  const TargetSurface target(attracting.mesh, attracting.patches);
  SurfaceAnchors anchors = anchors_of(input, settings.nodes);
  const auto [aligned, suffices] =
      align(input, without_excluded(source.mesh, source.patches).mesh, target, anchors, settings.similarity);
  source.mesh.vertices = aligned * source.mesh.vertices;
  Scene scene{
      std::move(source.mesh),    target, anchors, aligned * anchors.exact_sources(), anchors.exact_targets(),
      std::move(source.patches), {},     {}};
  scene.coarse_vertices = scene.surface.vertices;

  SurfaceFit fit;
  if (suffices)
    fit.summary.stop_reason = StopReason::converged;
  else
    fit.summary = deform(scene, aligned * anchors.sources, {options, settings, progress});
  const AnchorMeeting meeting =
      meet_anchors_within(scene.details(), scene.coarse_vertices, options.max_stretch, settings.details);
  fit.vertices = meeting.vertices.leftCols(input.source.vertices.cols());
  for (Eigen::Index k = 0; k < meeting.anchor_sigmas.size(); ++k)
    if (meeting.anchor_sigmas[k] > 0)
      fit.summary.anchors_given_way.push_back(
          {static_cast<std::size_t>(anchors.given[anchors.exact[k]]), meeting.anchor_sigmas[k]});
  fit.confidence =
      confidences({fit.vertices, input.source.faces}, input.source_patches, target, settings.confidence);
  for (std::size_t i = 0; i < std::min(scene.hidden.size(), fit.confidence.size()); ++i)
    if (scene.hidden[i]) {
      fit.confidence[i] = 0;
      fit.summary.cavity_vertices.push_back(static_cast<int>(i));
    }

  // Not those that refinement has added.
  std::erase_if(fit.summary.stretched_vertices,
                [&](int vertex) { return vertex >= input.source.vertices.cols(); });
  fit.summary.similarity_suffices = suffices;
  fit.summary.off_surface_anchors =
      static_cast<std::size_t>(input.anchor_sources.cols() - anchors.sources.cols());
  fit.summary.excluded_vertices = excluded_vertices(input, fit);
  measure_distances(input, target, fit);
  for (const double confidence : fit.confidence) fit.summary.unmatched_vertices += confidence > 0 ? 0 : 1;
  fit.summary.seconds = watch.seconds();
  return models.restored(std::move(fit));
}

}  // namespace bespoke
