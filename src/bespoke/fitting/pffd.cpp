#include "bespoke/fitting/pffd.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

/// Weight of the affine part against the faces', as a fraction of the area πλ² of the disc that a plane shows
/// to a point on it: small, so that the faces rule up to three quarters of λ, positive, so that they fade
/// out.
constexpr double background = 0.1 * 3.14159265358979323846;

/// Vertices that some face uses; the others say nothing about the shape.
std::vector<int> referenced_vertices(const TriangleMesh& mesh) {
  std::vector<char> used(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) used[static_cast<std::size_t>(mesh.faces(i))] = 1;
  std::vector<int> result;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) result.push_back(static_cast<int>(i));
  return result;
}

/// Least squares for the change of shape, of least norm, so that a flat source keeps its third dimension.
AffineMap affine_fit(const Points& from, const Points& to) {
  const Vector3 from_center = from.rowwise().mean();
  const Vector3 to_center = to.rowwise().mean();
  const Points arms = from.colwise() - from_center;
  const Points change = (to.colwise() - to_center) - arms;
  const Matrix3 spread = arms * arms.transpose();
  const Matrix3 cross = change * arms.transpose();
  const Matrix3 inverse = spread.completeOrthogonalDecomposition().pseudoInverse();
  AffineMap map;
  map.linear += cross * inverse;
  map.offset = to_center - map.linear * from_center;
  return map;
}

Matrix3 corners(const TriangleMesh& mesh, const Points& vertices, Eigen::Index face) {
  Matrix3 result;
  for (int corner = 0; corner < 3; ++corner) result.col(corner) = vertices.col(mesh.faces(corner, face));
  return result;
}

/// A source face and what carries it onto the fitted one.
struct FaceFrame {
  Vector3 a, ab, ac, normal;
  double bb, bc, cc, det;  ///< dot products of the edges and their Gram determinant
  double area;
  Vector3 shift;   ///< the face's affine map minus the background map, at a
  Matrix3 linear;  ///< the same difference's linear part

  Vector3 displacement(const Vector3& x) const { return shift + linear * (x - a); }
};

FaceFrame make_frame(const Matrix3& from, const Matrix3& to, const AffineMap& affine) {
  FaceFrame frame;
  frame.a = from.col(0);
  frame.ab = from.col(1) - from.col(0);
  frame.ac = from.col(2) - from.col(0);
  const Vector3 fitted_ab = to.col(1) - to.col(0);
  const Vector3 fitted_ac = to.col(2) - to.col(0);
  frame.bb = frame.ab.squaredNorm();
  frame.bc = frame.ab.dot(frame.ac);
  frame.cc = frame.ac.squaredNorm();
  frame.det = frame.bb * frame.cc - frame.bc * frame.bc;
  const Vector3& normal = frame.normal = frame.ab.cross(frame.ac);
  const Vector3 fitted_normal = fitted_ab.cross(fitted_ac);
  frame.area = normal.norm() / 2;
  // Unit normals times the square root of each face's area: as long as a typical edge, on both sides.
  const double scale = 1 / std::sqrt(normal.norm());
  const double fitted_length = fitted_normal.norm();
  const double fitted_scale = fitted_length > 0 ? 1 / std::sqrt(fitted_length) : 0;
  Matrix3 source_frame, fitted_frame;
  source_frame << frame.ab, frame.ac, scale * normal;
  fitted_frame << fitted_ab, fitted_ac, fitted_scale * fitted_normal;
  frame.linear = fitted_frame * source_frame.inverse() - affine.linear;
  frame.shift = to.col(0) - affine * frame.a;
  return frame;
}

/// From the closest point of the face to x.
Vector3 arm_from_face(const FaceFrame& face, const Vector3& x) {
  const Vector3 p = x - face.a;
  const double pb = face.ab.dot(p), pc = face.ac.dot(p);
  const double b = face.cc * pb - face.bc * pc, c = face.bb * pc - face.bc * pb;
  if (b >= 0 && c >= 0 && b + c <= face.det)
    return face.normal * (face.normal.dot(p) / face.normal.squaredNorm());
  // Outside, the closest point lies on an edge; the nearest of the three is cheap and free of cases.
  const Vector3 on_b = p - face.ab * std::clamp(pb / face.bb, 0.0, 1.0);
  const Vector3 on_c = p - face.ac * std::clamp(pc / face.cc, 0.0, 1.0);
  const Vector3 edge = face.ac - face.ab, q = p - face.ab;
  const Vector3 on_edge = q - edge * std::clamp(edge.dot(q) / edge.squaredNorm(), 0.0, 1.0);
  const double d_b = on_b.squaredNorm(), d_c = on_c.squaredNorm(), d_edge = on_edge.squaredNorm();
  if (d_b <= d_c && d_b <= d_edge) return on_b;
  return d_c <= d_edge ? on_c : on_edge;
}

/// Places on the surface no farther than `spacing` from any of its points.
std::vector<Vector3> cover(const TriangleMesh& mesh, const std::vector<int>& faces, double spacing) {
  std::vector<Vector3> places;
  std::vector<char> placed(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const int face : faces) {
    const Vector3 a = mesh.vertices.col(mesh.faces(0, face));
    const Vector3 ab = mesh.vertices.col(mesh.faces(1, face)) - a;
    const Vector3 ac = mesh.vertices.col(mesh.faces(2, face)) - a;
    const double longest = std::sqrt(std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}));
    const int steps = std::max(1, static_cast<int>(std::ceil(longest / spacing)));
    for (int corner = 0; corner < 3; ++corner) {
      const int vertex = mesh.faces(corner, face);
      if (!std::exchange(placed[static_cast<std::size_t>(vertex)], 1))
        places.emplace_back(mesh.vertices.col(vertex));
    }
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; i + j <= steps; ++j) {
        const bool corner = i == steps || j == steps || i + j == 0;
        if (!corner) places.push_back(a + ab * (double(i) / steps) + ac * (double(j) / steps));
      }
  }
  return places;
}

}  // namespace

struct PffdMap::Frames {
  AffineMap affine;
  std::vector<FaceFrame> faces;
  std::vector<int> mesh_faces;  ///< index in the source of each of `faces`
  double reach = 0;             ///< λ plus the largest distance of a face's centre from its corners
  std::unique_ptr<const PointGrid> centers;
};

PffdMap::PffdMap(const TriangleMesh& source, const Points& fitted, double lambda)
    : source_(source), fitted_(fitted), lambda_(lambda) {
  require_valid(source, "source of the p-FFD");
  if (fitted.cols() != source.vertices.cols())
    throw InvalidInput("p-FFD: " + std::to_string(source.vertices.cols()) + " source vertices, but " +
                       std::to_string(fitted.cols()) + " fitted ones");
  if (!fitted.allFinite()) throw InvalidInput("p-FFD: a fitted vertex is not finite");
  if (!(lambda > 0 && std::isfinite(lambda)))
    throw InvalidInput("p-FFD: lambda is " + std::to_string(lambda) + ", but must be finite and above 0");

  auto frames = std::make_unique<Frames>();
  const std::vector<int> used = referenced_vertices(source);
  frames->affine = affine_fit(source.vertices(Eigen::all, used), fitted(Eigen::all, used));
  const double no_area = 1e-14 * std::pow(diagonal(source.vertices), 2);  // as MeshFindings counts them
  std::vector<Vector3> centers;
  for (Eigen::Index face = 0; face < source.faces.cols(); ++face) {
    const Matrix3 from = corners(source, source.vertices, face);
    const Matrix3 to = corners(source, fitted, face);
    const double area = (from.col(1) - from.col(0)).cross(from.col(2) - from.col(0)).norm() / 2;
    if (!(area > no_area)) continue;
    frames->faces.push_back(make_frame(from, to, frames->affine));
    frames->mesh_faces.push_back(static_cast<int>(face));
    centers.emplace_back(from.rowwise().mean());
    const double radius = (from.colwise() - centers.back()).colwise().norm().maxCoeff();
    frames->reach = std::max(frames->reach, lambda + radius);
  }
  if (centers.empty()) throw InvalidInput("p-FFD: no face of the source has any area");
  const Points center_points = Points::Map(centers.front().data(), 3, static_cast<int>(centers.size()));
  frames->centers = std::make_unique<PointGrid>(center_points, frames->reach / 2);
  frames_ = std::move(frames);
}

PffdMap::~PffdMap() = default;

AffineMap PffdMap::affine() const { return frames_->affine; }

namespace {

/// The faces within λ of a point.
struct Near {
  const FaceFrame* face;
  Vector3 arm;  ///< from the face to the point
  double s;     ///< (distance / λ)²
};

/// u at a point, with what its gradient needs.
struct Blend {
  Vector3 displacement = Vector3::Zero();
  double total_weight = 0;
  double nearest = 1;  ///< s of the nearest face; 0: only the faces that touch the point count, evenly
};

double weight(const Near& at, const Blend& blend) {
  if (!(blend.nearest > 0)) return at.s > 0 ? 0 : 1;
  const double ratio = blend.nearest / at.s, fade = 1 - at.s;
  return at.face->area * ratio * ratio * fade * fade * fade;
}

Blend blend_faces(const std::vector<Near>& near, const Vector3& x, double lambda) {
  Blend blend;
  if (near.empty()) return blend;
  for (const Near& at : near) blend.nearest = std::min(blend.nearest, at.s);
  // Weights relative to 1/s² of the nearest face stay finite near the surface.
  blend.total_weight = background * lambda * lambda * blend.nearest * blend.nearest;
  for (const Near& at : near) {
    const double share = weight(at, blend);
    blend.displacement += share * at.face->displacement(x);
    blend.total_weight += share;
  }
  blend.displacement /= blend.total_weight;
  return blend;
}

Matrix3 blend_gradient(const std::vector<Near>& near, const Vector3& x, double lambda) {
  Matrix3 gradient = Matrix3::Zero();
  if (near.empty()) return gradient;
  const Blend blend = blend_faces(near, x, lambda);
  for (const Near& at : near) {
    const double share = weight(at, blend);
    gradient += share * at.face->linear;
    if (!(blend.nearest > 0)) continue;
    // d/ds (1 − s)³ / s² = −(1 − s)² (s + 2) / s³, and ∇s = 2 arm / λ².
    const double slope = -share * (at.s + 2) / (at.s * (1 - at.s));
    const Vector3 off = at.face->displacement(x) - blend.displacement;
    gradient += off * (slope * 2 / (lambda * lambda) * at.arm).transpose();
  }
  return gradient / blend.total_weight;
}

}  // namespace

template <class Take>
void PffdMap::for_each_neighbourhood(const Points& x, const Take& take) const {
  parallel_for(static_cast<std::size_t>(x.cols()), 32, [&](std::size_t begin, std::size_t end) {
    std::vector<Near> near;
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Vector3 at = x.col(column);
      near.clear();
      frames_->centers->for_each_within(at, frames_->reach, [&](int index, double) {
        const FaceFrame& face = frames_->faces[static_cast<std::size_t>(index)];
        const Vector3 arm = arm_from_face(face, at);
        const double s = arm.squaredNorm() / (lambda_ * lambda_);
        if (s < 1) near.push_back({&face, arm, s});
      });
      take(column, near, at);
    }
  });
}

Points PffdMap::displacement(const Points& x) const {
  Points result(3, x.cols());
  for_each_neighbourhood(x, [&](Eigen::Index i, const std::vector<Near>& near, const Vector3& at) {
    result.col(i) = blend_faces(near, at, lambda_).displacement;
  });
  return result;
}

Points PffdMap::displacement_gradient(const Points& x) const {
  Points result(3, 3 * x.cols());
  for_each_neighbourhood(x, [&](Eigen::Index i, const std::vector<Near>& near, const Vector3& at) {
    result.middleCols<3>(3 * i) = blend_gradient(near, at, lambda_);
  });
  return result;
}

Support PffdMap::support() const {
  // One ball per place; an eighth of λ keeps their number low and the excess of the band small.
  const double spacing = lambda_ / 8;
  const std::vector<Vector3> places = cover(source_, frames_->mesh_faces, spacing);
  Support support;
  support.clouds.push_back(
      {Points::Map(places.front().data(), 3, static_cast<int>(places.size())), lambda_ + spacing});
  return support;
}

}  // namespace bespoke
