#include "bespoke/alignment/detail/patch_deformation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bespoke/rigid/as_similar_as_possible.h"

namespace bespoke {
namespace {

struct DeformationSettings {
  double first_length = 0.2;  // of the target's radius: what the similarities leave
  double last_length = 0.5;   // of the patches' spacing: below it one patch outweighs its neighbours
  int iterations = 40;
  // Curled fingers need less; wrong starts stay wrong with more (tests/accuracy/tuning.md).
  double stiffness = 20;
  double free_floating = 1e-9;  // weight that keeps a patch without matches where it is
  // What patches of differently meshed copies of one surface leave: measured on a remeshed head (0.014 and
  // 0.03), less what the residual of a perfect match has anyway. Below it, shapes count as equal.
  double residual_noise = 0.003;
  double bending_noise = 0.01;
};
constexpr DeformationSettings deformation_settings;

/// Between patches within two links, each with its area's share over its links and their squared lengths.
GraphEdges make_links(const SurfacePatches& source) {
  GraphEdges links(source.neighbours.size());
  for (std::size_t i = 0; i < links.size(); ++i) {
    std::vector<int> wide = source.neighbours[i];
    for (const int j : source.neighbours[i])
      wide.insert(wide.end(), source.neighbours[j].begin(), source.neighbours[j].end());
    std::sort(wide.begin(), wide.end());
    wide.erase(std::unique(wide.begin(), wide.end()), wide.end());
    std::erase(wide, static_cast<int>(i));
    const auto column = static_cast<Eigen::Index>(i);
    for (const int j : wide) {
      const Vector3 rest = source.points.col(j) - source.points.col(column);
      const double share = source.areas[column] / double(wide.size());
      if (rest.squaredNorm() > 0) links[i].push_back({j, rest, share / rest.squaredNorm()});
    }
  }
  return links;
}

/// Root mean square deviation of the links from the similarity around their patch, relative to its scale.
double bending_of(const AsSimilarAsPossible& graph, const Points& points) {
  double sum = 0;
  for (std::size_t i = 0; i < graph.edges().size(); ++i) {
    const Matrix3& similarity = graph.similarities[i];
    const double squared_scale = similarity.squaredNorm() / 3;  // a rotation's squared norm is 3
    for (const GraphEdge& link : graph.edges()[i]) {
      const Vector3 now = points.col(link.to) - points.col(static_cast<Eigen::Index>(i));
      sum += link.weight * (now - similarity * link.rest).squaredNorm() / squared_scale;
    }
  }
  return std::sqrt(sum);
}

/// The points drawn to their matches; free_floating keeps a patch without any.
Points moved_to_matches(AsSimilarAsPossible& graph, const PatchDeformation& state, double stiffness) {
  const Points& now = state.points;
  std::vector<SoftConstraint> constraints;
  Points targets(3, now.cols());
  for (Eigen::Index i = 0; i < now.cols(); ++i) {
    const double matched = state.matches.weights[i], weight = matched + deformation_settings.free_floating;
    constraints.push_back({{{static_cast<int>(i), 1}}, weight});
    targets.col(i) =
        (matched * state.matches.targets.col(i) + deformation_settings.free_floating * now.col(i)) / weight;
  }
  graph.set_constraints(std::move(constraints), stiffness);
  return graph.places(targets);
}

}  // namespace

double PatchDeformation::misfit() const {
  return std::sqrt((residual + deformation_settings.residual_noise) *
                   (bending + deformation_settings.bending_noise)) /
         matches.matched();
}

PatchDeformation deform_patches(const SurfacePatches& source, const SurfacePatches& target,
                                const Similarity& start) {
  AsSimilarAsPossible graph(make_links(source));
  PatchDeformation state;
  state.points = start * source.points;
  state.normals = start.rotation * source.normals;
  graph.similarities.assign(graph.similarities.size(), start.scale * start.rotation);
  const double first = deformation_settings.first_length * target.radius;
  const double last =
      deformation_settings.last_length * std::max(target.spacing, start.scale * source.spacing);
  for (int iteration = 0; iteration < deformation_settings.iterations; ++iteration) {
    const double progress = iteration / double(deformation_settings.iterations - 1);
    const double length = first * std::pow(last / first, progress);
    state.matches = soft_matches(source, state.points, state.normals, target, length);
    const double in_source = length / start.scale;  // the links' weights are those of the source's lengths
    state.points = moved_to_matches(graph, state, deformation_settings.stiffness * in_source * in_source);
    graph.fit_similarities(state.points);
    for (Eigen::Index i = 0; i < state.normals.cols(); ++i)
      state.normals.col(i) =
          (graph.similarities[static_cast<std::size_t>(i)] * source.normals.col(i)).normalized();
  }
  state.bending = bending_of(graph, state.points);
  state.similarities = std::move(graph.similarities);
  state.residual = state.matches.residual(state.points) / target.radius;
  return state;
}

double distortion(const TriangleMesh& mesh, SurfacePatches patches, const Points& placed) {
  const Eigen::VectorXd areas = vertex_areas(mesh);
  Points moved = Points::Zero(3, patches.size());
  patches.points.setZero();
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(patches.size());
  for (Eigen::Index i = 0; i < placed.cols(); ++i) {
    const int patch = patches.patch_of_vertex[static_cast<std::size_t>(i)];
    if (patch < 0) continue;
    sums[patch] += areas[i];
    patches.points.col(patch) += areas[i] * mesh.vertices.col(i);
    moved.col(patch) += areas[i] * placed.col(i);
  }
  patches.points *= sums.cwiseInverse().asDiagonal();
  moved *= sums.cwiseInverse().asDiagonal();
  AsSimilarAsPossible graph(make_links(patches));
  graph.fit_similarities(moved);
  return bending_of(graph, moved);
}

Points deformed_vertices(const TriangleMesh& mesh, const SurfacePatches& patches,
                         const PatchDeformation& deformation, const Similarity& elsewhere) {
  Points places = elsewhere * mesh.vertices;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const int own = patches.patch_of_vertex[static_cast<std::size_t>(i)];
    if (own < 0) continue;
    std::vector<int> around = patches.neighbours[static_cast<std::size_t>(own)];
    around.push_back(own);
    Vector3 sum = Vector3::Zero();
    double total = 0;
    for (const int k : around) {
      const Vector3 arm = mesh.vertices.col(i) - patches.points.col(k);
      const double weight = std::exp(-arm.squaredNorm() / (patches.spacing * patches.spacing));
      sum +=
          weight * (deformation.points.col(k) + deformation.similarities[static_cast<std::size_t>(k)] * arm);
      total += weight;
    }
    places.col(i) = sum / total;
  }
  return places;
}

}  // namespace bespoke
