#include "bespoke/pattern/cloth_strain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "bespoke/pattern/flattening/flat_faces.h"

namespace bespoke {
namespace {

using Weighted = std::vector<std::pair<double, double>>;  // value, area

/// Of values by area, in ascending order.
double percentile(const Weighted& sorted, double fraction) {
  double whole = 0, sum = 0;
  for (const auto& [value, area] : sorted) whole += area;
  for (const auto& [value, area] : sorted)
    if ((sum += area) >= fraction * whole) return value;
  return sorted.back().first;
}

/// Principal stretches of a Jacobian, the larger first: half the sum and half the difference are the scales
/// of its similar and its mirrored part.
Eigen::Vector2d stretches(const Eigen::Matrix2d& a) {
  const double mean = std::hypot(a(0, 0) + a(1, 1), a(1, 0) - a(0, 1)) / 2;
  const double half = std::hypot(a(0, 0) - a(1, 1), a(1, 0) + a(0, 1)) / 2;
  return {mean + half, mean - half};
}

}  // namespace

ClothStrain cloth_strain(const Piece& piece, const Eigen::Matrix2Xd& flat) {
  const std::vector<RestFace> rest = rest_faces(piece.mesh);
  ClothStrain strain;
  strain.of_face.resize(piece.mesh.faces.cols());
  Weighted all, worst;
  double surface = 0, plane = 0;
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
    const RestFace& face = rest[static_cast<std::size_t>(f)];
    const Eigen::Matrix2d flat_from_surface = face_jacobian(face, piece.mesh.faces.col(f), flat);
    const Eigen::Vector2d of_cloth = stretches(flat_from_surface).cwiseInverse();
    for (const double stretch : of_cloth) all.emplace_back(stretch, face.area);
    strain.of_face[f] = (of_cloth.array() - 1).abs().maxCoeff();
    worst.emplace_back(strain.of_face[f], face.area);
    surface += face.area;
    plane += face.area * flat_from_surface.determinant();
  }
  std::sort(all.begin(), all.end());
  std::sort(worst.begin(), worst.end());
  strain.min = all.front().first;
  strain.p5 = percentile(all, 0.05);
  strain.p95 = percentile(all, 0.95);
  strain.max = all.back().first;
  strain.strain_p95 = percentile(worst, 0.95);
  strain.area_change = surface / plane - 1;
  return strain;
}

std::string to_string(const ClothStrain& strain) {
  char text[160];
  std::snprintf(text, sizeof text, "stretch %.3f … %.3f (p5 %.3f, p95 %.3f), area %+.2f %%", strain.min,
                strain.max, strain.p5, strain.p95, 100 * strain.area_change);
  return text;
}

StretchExcess stretch_beyond(const Piece& piece, const Eigen::Matrix2Xd& flat, const Eigen::Vector2d& grain,
                             const StretchLimits& limits) {
  const std::vector<RestFace> rest = rest_faces(piece.mesh);
  const Eigen::Vector2d across(-grain.y(), grain.x());
  StretchExcess excess;
  double whole = 0, beyond = 0;
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
    const RestFace& face = rest[static_cast<std::size_t>(f)];
    const Eigen::Matrix2d surface_from_flat = face_jacobian(face, piece.mesh.faces.col(f), flat).inverse();
    const double warp = (surface_from_flat * grain).norm() - 1,
                 weft = (surface_from_flat * across).norm() - 1;
    excess.warp_max = std::max(excess.warp_max, warp);
    excess.weft_max = std::max(excess.weft_max, weft);
    whole += face.area;
    if (warp > limits.warp || weft > limits.weft) beyond += face.area;
  }
  excess.area_share = beyond / whole;
  return excess;
}

}  // namespace bespoke
