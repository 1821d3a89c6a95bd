#include "bespoke/quality/surface_strain.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "bespoke/error.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

using Edges = Eigen::Matrix<double, 3, 2>;
Edges edges(const Points& vertices, const Faces& faces, Eigen::Index face) {
  const Vector3 corner = vertices.col(faces(0, face));
  Edges both;
  both << vertices.col(faces(1, face)) - corner, vertices.col(faces(2, face)) - corner;
  return both;
}

/// Half of the parallelogram; 0 where the face's height is rounding beside its length.
double area(const Edges& face) {
  constexpr double least = 1e-12;  // of a squared edge
  const double doubled = face.col(0).cross(face.col(1)).norm();
  return doubled > least * face.squaredNorm() ? doubled / 2 : 0;
}

/// Hencky (logarithmic) strain.
/// ln² s₁ + ln² s₂ of a face that had an area; s₁², s₂² are the eigenvalues of CᵀC, C = A R⁻¹, with
/// B = Q R its edges before and A those after.
double squared_strain(const Edges& before, const Edges& after) {
  constexpr double most = 10;
  const Eigen::HouseholderQR<Edges> qr(before);
  const Eigen::Matrix2d upper = qr.matrixQR().topRows<2>().triangularView<Eigen::Upper>();
  const Edges gradient = after * upper.inverse();  // except for a rotation
  const Eigen::Matrix2d metric = gradient.transpose() * gradient;
  const double mean = metric.trace() / 2;
  const double half_difference = std::sqrt(std::max(0.0, mean * mean - metric.determinant()));
  const Eigen::Array2d squares(mean + half_difference, mean - half_difference);
  return (squares.max(1 / (most * most)).min(most * most).log() / 2).matrix().squaredNorm();
}

}  // namespace

Eigen::VectorXd strain_around(const TriangleMesh& surface, const Points& registered,
                              const std::vector<SurfacePoint>& places, double reach) {
  if (registered.cols() != surface.vertices.cols())
    throw InvalidInput("strain_around got " + std::to_string(registered.cols()) + " vertices after and " +
                       std::to_string(surface.vertices.cols()) + " before");
  if (!(reach > 0 && surface.vertices.allFinite() && registered.allFinite()))
    throw InvalidInput("strain_around needs finite points and a reach above 0, got " + std::to_string(reach));
  const Eigen::Index faces = surface.faces.cols();
  Points centers(3, faces);
  Eigen::VectorXd areas(faces), strains(faces);
  double area_after = 0;
  for (Eigen::Index face = 0; face < faces; ++face) {
    const Edges before = edges(surface.vertices, surface.faces, face);
    centers.col(face) = surface.vertices.col(surface.faces(0, face)) + before.rowwise().sum() / 3;
    areas[face] = area(before);
    area_after += area(edges(registered, surface.faces, face));
  }
  if (!(areas.sum() > 0 && area_after > 0)) throw InvalidInput("the surface has no area");
  const double usual = std::sqrt(area_after / areas.sum());
  for (Eigen::Index face = 0; face < faces; ++face)
    strains[face] = areas[face] > 0 ? squared_strain(usual * edges(surface.vertices, surface.faces, face),
                                                     edges(registered, surface.faces, face))
                                    : 0;

  Eigen::VectorXd around(static_cast<Eigen::Index>(places.size()));
  parallel_for(places.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double sum = 0, weight = 0;
      for (Eigen::Index face = 0; face < faces; ++face)
        if (face == places[k].face || (centers.col(face) - places[k].point).squaredNorm() <= reach * reach) {
          sum += areas[face] * strains[face];
          weight += areas[face];
        }
      around[static_cast<Eigen::Index>(k)] = weight > 0 ? std::sqrt(sum / weight) : 0;
    }
  });
  return around;
}

}  // namespace bespoke
