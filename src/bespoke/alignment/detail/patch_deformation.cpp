#include "bespoke/alignment/detail/patch_deformation.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>

#include "bespoke/error.h"
#include "bespoke/rigid/nearest_rotation.h"

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

/// From patch i to patch j, within two links.
struct Link {
  int to = 0;
  Vector3 rest;       // mesh units, source frame
  double weight = 0;  // area share / links of the patch / |rest|²
};
using Links = std::vector<std::vector<Link>>;

Links make_links(const SurfacePatches& source) {
  Links links(source.neighbours.size());
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

/// Local step of an as-similar-as-possible deformation (Igarashi 2005; Sorkine, Alexa 2007).
/// The similarity around every patch; turns the normals with it and measures the bending.
void update_similarities(const SurfacePatches& source, const Links& links, PatchDeformation& state) {
  double sum = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    Matrix3 covariance = Matrix3::Zero();
    double spread = 0;
    for (const Link& link : links[i]) {
      const Vector3 now = state.points.col(link.to) - state.points.col(column);
      covariance += link.weight * now * link.rest.transpose();
      spread += link.weight * link.rest.squaredNorm();
    }
    const NearestRotation nearest = nearest_rotation(covariance);
    const double scale = nearest.trace / spread;
    state.similarities[i] = scale * nearest.rotation;
    state.normals.col(column) = nearest.rotation * source.normals.col(column);
    for (const Link& link : links[i]) {
      const Vector3 now = state.points.col(link.to) - state.points.col(column);
      sum += link.weight * (now - state.similarities[i] * link.rest).squaredNorm() / (scale * scale);
    }
  }
  state.bending = std::sqrt(sum);
}

/// The global step: Σ_i w_i |x_i − y_i|² + stiffness Σ_ij |x_j − x_i − S_i e_ij|², whose matrix has one
/// pattern throughout.
class PatchSystem {
 public:
  explicit PatchSystem(const Links& links) : links_(links) {}

  Points solve(const PatchDeformation& state, double stiffness) {
    const auto size = static_cast<Eigen::Index>(links_.size());
    std::vector<Eigen::Triplet<double>> entries;
    Points right = state.matches.targets * state.matches.weights.asDiagonal();
    right += deformation_settings.free_floating * state.points;
    for (Eigen::Index i = 0; i < size; ++i)
      entries.emplace_back(i, i, state.matches.weights[i] + deformation_settings.free_floating);
    for (Eigen::Index i = 0; i < size; ++i)
      for (const Link& link : links_[static_cast<std::size_t>(i)]) {
        const double weight = stiffness * link.weight;
        const Vector3 pull = weight * (state.similarities[static_cast<std::size_t>(i)] * link.rest);
        entries.emplace_back(i, i, weight);
        entries.emplace_back(link.to, link.to, weight);
        entries.emplace_back(i, link.to, -weight);
        entries.emplace_back(link.to, i, -weight);
        right.col(link.to) += pull;
        right.col(i) -= pull;
      }
    Eigen::SparseMatrix<double> matrix(size, size);
    matrix.setFromTriplets(entries.begin(), entries.end());
    if (!analyzed_) solver_.analyzePattern(matrix);
    analyzed_ = true;
    solver_.factorize(matrix);
    if (solver_.info() != Eigen::Success)
      throw SolverError("alignment: the system of the patches is singular");
    return solver_.solve(Eigen::MatrixX3d(right.transpose())).transpose();
  }

 private:
  const Links& links_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  bool analyzed_ = false;
};

}  // namespace

double PatchDeformation::misfit() const {
  return std::sqrt((residual + deformation_settings.residual_noise) *
                   (bending + deformation_settings.bending_noise)) /
         matches.matched();
}

PatchDeformation deform_patches(const SurfacePatches& source, const SurfacePatches& target,
                                const Similarity& start) {
  const Links links = make_links(source);
  PatchSystem system(links);
  PatchDeformation state;
  state.points = start * source.points;
  state.normals = start.rotation * source.normals;
  state.similarities.assign(links.size(), start.scale * start.rotation);
  const double first = deformation_settings.first_length * target.radius;
  const double last =
      deformation_settings.last_length * std::max(target.spacing, start.scale * source.spacing);
  for (int iteration = 0; iteration < deformation_settings.iterations; ++iteration) {
    const double progress = iteration / double(deformation_settings.iterations - 1);
    const double length = first * std::pow(last / first, progress);
    state.matches = soft_matches(source, state.points, state.normals, target, length);
    const double in_source = length / start.scale;  // the links' weights are those of the source's lengths
    state.points = system.solve(state, deformation_settings.stiffness * in_source * in_source);
    update_similarities(source, links, state);
  }
  state.residual = state.matches.residual(state.points) / target.radius;
  return state;
}

double distortion(const TriangleMesh& mesh, SurfacePatches patches, const Points& placed) {
  const Eigen::VectorXd areas = vertex_areas(mesh);
  PatchDeformation moved;
  moved.points = moved.normals = Points::Zero(3, patches.size());
  moved.similarities.resize(static_cast<std::size_t>(patches.size()));
  patches.points.setZero();
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(patches.size());
  for (Eigen::Index i = 0; i < placed.cols(); ++i) {
    const int patch = patches.patch_of_vertex[static_cast<std::size_t>(i)];
    if (patch < 0) continue;
    sums[patch] += areas[i];
    patches.points.col(patch) += areas[i] * mesh.vertices.col(i);
    moved.points.col(patch) += areas[i] * placed.col(i);
  }
  patches.points *= sums.cwiseInverse().asDiagonal();
  moved.points *= sums.cwiseInverse().asDiagonal();
  update_similarities(patches, make_links(patches), moved);
  return moved.bending;
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
