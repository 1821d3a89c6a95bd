#include "bespoke/quality/detail/surface_samples.h"

#include <cmath>

namespace bespoke {
namespace {

double area(const TriangleMesh& mesh, Eigen::Index face) {
  const Vector3 a = mesh.vertices.col(mesh.faces(0, face));
  const Vector3 ab = mesh.vertices.col(mesh.faces(1, face)) - a;
  const Vector3 ac = mesh.vertices.col(mesh.faces(2, face)) - a;
  return ab.cross(ac).norm() / 2;
}

double fraction(double x) { return x - std::floor(x); }

// Point i of the R2 sequence, whose first points always cover the unit square evenly, folded onto the
// triangle.
Vector3 spread_over_triangle(std::size_t i) {
  constexpr double plastic = 1.32471795724474602596;
  double u = fraction(0.5 + static_cast<double>(i) / plastic);
  double v = fraction(0.5 + static_cast<double>(i) / (plastic * plastic));
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  return {1 - u - v, u, v};
}

}  // namespace

SurfaceSamples sample_surface(const TriangleMesh& mesh, std::size_t count) {
  double total = 0;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) total += area(mesh, face);
  SurfaceSamples samples;
  if (!(total > 0)) return samples;
  std::vector<Vector3> barycentric;
  const double share = total / static_cast<double>(count);
  double passed = 0;
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    passed += area(mesh, face);
    while (barycentric.size() < count && (static_cast<double>(barycentric.size()) + 0.5) * share < passed) {
      samples.faces.push_back(static_cast<int>(face));
      barycentric.push_back(spread_over_triangle(barycentric.size()));
    }
  }
  samples.barycentric.resize(3, static_cast<Eigen::Index>(barycentric.size()));
  for (std::size_t i = 0; i < barycentric.size(); ++i)
    samples.barycentric.col(static_cast<Eigen::Index>(i)) = barycentric[i];
  return samples;
}

Points positions(const SurfaceSamples& samples, const TriangleMesh& mesh) {
  Points points = Points::Zero(3, samples.barycentric.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    for (int corner = 0; corner < 3; ++corner)
      points.col(i) += samples.barycentric(corner, i) *
                       mesh.vertices.col(mesh.faces(corner, samples.faces[static_cast<std::size_t>(i)]));
  return points;
}

}  // namespace bespoke
