#include "bespoke/bake/detail/face_turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "bespoke/lattice/baked_map.h"
#include "bespoke/mesh/triangle_mesh.h"

namespace bespoke {
namespace {

/// The least of the three, mesh units.
double height(const Matrix3& corners) {
  const Vector3 a = corners.col(1) - corners.col(0), b = corners.col(2) - corners.col(0);
  const double longest = std::max({a.squaredNorm(), b.squaredNorm(), (b - a).squaredNorm()});
  return longest > 0 ? a.cross(b).norm() / std::sqrt(longest) : 0;
}

}  // namespace

FaceTurns::FaceTurns(const ElasticMap& map, const BakeOptions& options, double thinnest)
    : map_(map), options_(options) {
  if (!options.surface) return;
  const TriangleMesh& surface = *options.surface;
  for (Eigen::Index face = 0; face < surface.faces.cols(); ++face)
    if (height(surface.vertices(Eigen::all, surface.faces.col(face))) >= thinnest) faces_.push_back(face);
  normals_ = normals(map);
}

std::vector<Eigen::Index> FaceTurns::misoriented_faces(Pyramid& pyramid) const {
  if (faces_.empty()) return {};
  BakedMap baked(map_.affine(), std::move(pyramid));
  const Eigen::VectorXd cosines = normals(baked).cwiseProduct(normals_).colwise().sum();
  pyramid = std::move(baked).release();
  const double min_cosine = std::cos(options_.max_face_turn * std::numbers::pi / 180);
  std::vector<std::pair<double, Eigen::Index>> turned;
  for (std::size_t k = 0; k < faces_.size(); ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const bool has_normal = normals_.col(column).squaredNorm() > 0;
    if (has_normal && cosines[column] < min_cosine) turned.emplace_back(cosines[column], faces_[k]);
  }
  std::sort(turned.begin(), turned.end());
  std::vector<Eigen::Index> faces;
  for (const auto& [cosine, face] : turned) faces.push_back(face);
  return faces;
}

Points FaceTurns::places(const std::vector<Eigen::Index>& faces) const {
  Points places(3, 4 * static_cast<Eigen::Index>(faces.size()));
  Eigen::Index column = 0;
  for (const Eigen::Index face : faces) {
    const Matrix3 corners = options_.surface->vertices(Eigen::all, options_.surface->faces.col(face));
    places.middleCols<3>(column) = corners;
    places.col(column + 3) = corners.rowwise().mean();
    column += 4;
  }
  return places;
}

Points FaceTurns::normals(const ElasticMap& map) const {
  Points ends = map(options_.surface->vertices);
  if (options_.downstream_map) ends = (*options_.downstream_map)(ends);
  return face_normals({std::move(ends), options_.surface->faces(Eigen::all, faces_)});
}

}  // namespace bespoke
