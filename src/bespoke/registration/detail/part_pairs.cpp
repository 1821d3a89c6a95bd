#include "bespoke/registration/detail/part_pairs.h"

#include <Eigen/Eigenvalues>
#include <set>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/spread_points.h"

namespace bespoke {
namespace {

constexpr std::size_t pairs_a_part = 40;
constexpr double sigma_of_part_pairs =
    0.01;  // of the target's diagonal, as of pairs by distances along surfaces

TriangleMesh mesh_of_part(const Points& vertices, const Faces& faces, const std::vector<int>& of_face,
                          int part) {
  std::vector<Eigen::Index> own;
  for (std::size_t k = 0; k < of_face.size(); ++k)
    if (of_face[k] == part) own.push_back(static_cast<Eigen::Index>(k));
  return {vertices, faces(Eigen::all, own)};
}

/// Of a surface with constant density.
struct Moments {
  Vector3 mean = Vector3::Zero();
  Matrix3 covariance = Matrix3::Zero();
};

Moments moments_of(const TriangleMesh& mesh) {
  double area = 0;
  Moments result;
  Matrix3 second = Matrix3::Zero();
  for (const auto& face : mesh.faces.colwise()) {
    const Matrix3 corners = mesh.vertices(Eigen::all, face);
    const Vector3 middle = corners.rowwise().mean();
    const double own = 0.5 * (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0)).norm();
    area += own;
    result.mean += own * middle;
    second += own / 12 * (corners * corners.transpose() + 9 * middle * middle.transpose());
  }
  if (!(area > 0)) return result;
  result.mean /= area;
  result.covariance = second / area - result.mean * result.mean.transpose();
  return result;
}

Matrix3 matrix_root(const Matrix3& covariance) {
  return Eigen::SelfAdjointEigenSolver<Matrix3>(covariance).operatorSqrt();
}

/// The symmetric positive matrix T with T A T = B.
Matrix3 transport(Matrix3 a, Matrix3 b) {
  constexpr double flat = 1e-6;  // of the spread: thinner parts are as thin as each other
  a += flat * a.trace() * Matrix3::Identity();
  b += flat * b.trace() * Matrix3::Identity();
  const Matrix3 of_a = matrix_root(a), back = of_a.inverse();
  return back * matrix_root(of_a * b * of_a) * back;
}

std::set<int> parts_with_anchors(const MatchedModels& models, const Points& anchor_sources) {
  const ClosestPointTree tree(models.source);
  std::set<int> parts;
  for (const auto& anchor : anchor_sources.colwise())
    parts.insert(models.parts.source.of_face[static_cast<std::size_t>(tree.closest(Vector3(anchor))->face)]);
  return parts;
}

}  // namespace

std::vector<AnchorPair> part_pairs(const MatchedModels& models, const Points& anchor_sources) {
  std::vector<AnchorPair> pairs;
  if (!models.parts.correspond()) return pairs;
  const std::set<int> anchored = parts_with_anchors(models, anchor_sources);
  const double sigma = sigma_of_part_pairs * diagonal(models.target.vertices);
  for (int part = 0; part < static_cast<int>(models.parts.source.sizes.size()); ++part) {
    if (anchored.contains(part)) continue;
    const TriangleMesh own =
        mesh_of_part(models.placed, models.source.faces, models.parts.source.of_face, part);
    const TriangleMesh other =
        mesh_of_part(models.target.vertices, models.target.faces, models.parts.target.of_face, part);
    const Moments from = moments_of(own), to = moments_of(other);
    if (!(from.covariance.trace() > 0 && to.covariance.trace() > 0)) continue;
    const Matrix3 map = transport(from.covariance, to.covariance);
    const ClosestPointTree surface(other);
    for (const int vertex : spread_vertices(own, pairs_a_part)) {
      AnchorPair pair;
      pair.a = models.source.vertices.col(vertex);
      pair.b = surface.closest(to.mean + map * (own.vertices.col(vertex) - from.mean))->point;
      pair.sigma = sigma;
      pairs.push_back(pair);
    }
  }
  return pairs;
}

}  // namespace bespoke
