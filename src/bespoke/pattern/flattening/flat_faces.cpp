#include "bespoke/pattern/flattening/flat_faces.h"

#include <string>

#include "bespoke/error.h"

namespace bespoke {

std::vector<RestFace> rest_faces(const TriangleMesh& mesh) {
  // As degenerate faces are counted in inspect_mesh.
  constexpr double area_floor = 1e-14;
  const double floor = area_floor * diagonal(mesh.vertices) * diagonal(mesh.vertices);
  std::vector<RestFace> rest(static_cast<std::size_t>(mesh.faces.cols()));
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const Vector3 a = mesh.vertices.col(mesh.faces(0, f));
    const Vector3 ab = mesh.vertices.col(mesh.faces(1, f)) - a, ac = mesh.vertices.col(mesh.faces(2, f)) - a;
    const double twice_area = ab.cross(ac).norm();
    if (!(twice_area > 2 * floor)) throw InvalidInput("face " + std::to_string(f + 1) + " has no area");
    Eigen::Matrix2d edges;  // of the corners 1 and 2 from corner 0, x along the first
    edges << ab.norm(), ab.dot(ac) / ab.norm(), 0, twice_area / ab.norm();
    const Eigen::Matrix2d inverse = edges.inverse();
    RestFace& face = rest[static_cast<std::size_t>(f)];
    face.gradients.rightCols<2>() = inverse.transpose();
    face.gradients.col(0) = -face.gradients.col(1) - face.gradients.col(2);
    face.area = twice_area / 2;
  }
  return rest;
}

Eigen::Matrix2d face_jacobian(const RestFace& rest, const Eigen::Vector3i& face,
                              const Eigen::Matrix2Xd& flat) {
  return flat.col(face[0]) * rest.gradients.col(0).transpose() +
         flat.col(face[1]) * rest.gradients.col(1).transpose() +
         flat.col(face[2]) * rest.gradients.col(2).transpose();
}

bool is_unflipped(const TriangleMesh& mesh, const std::vector<RestFace>& rest, const Eigen::Matrix2Xd& flat) {
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f)
    if (!(face_jacobian(rest[static_cast<std::size_t>(f)], mesh.faces.col(f), flat).determinant() > 0))
      return false;
  return true;
}

Eigen::SparseMatrix<double> stiffness(const TriangleMesh& mesh, const std::vector<RestFace>& rest) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(static_cast<std::size_t>(9 * mesh.faces.cols()));
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const RestFace& face = rest[static_cast<std::size_t>(f)];
    const Eigen::Matrix3d products = face.area * face.gradients.transpose() * face.gradients;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) entries.emplace_back(mesh.faces(i, f), mesh.faces(j, f), products(i, j));
  }
  Eigen::SparseMatrix<double> matrix(mesh.vertices.cols(), mesh.vertices.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace bespoke
