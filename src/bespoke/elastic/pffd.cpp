#include "bespoke/elastic/pffd.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bespoke/elastic/detail/face_distances.h"
#include "bespoke/error.h"
#include "bespoke/parallel.h"

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
  Vector3 shift;   ///< the face's affine map minus the background map, at the origin of the frames
  Matrix3 linear;  ///< the same difference's linear part
};

FaceFrame make_frame(const Matrix3& from, const Matrix3& to, const AffineMap& affine, const Vector3& origin) {
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
  frame.shift = to.col(0) - affine * frame.a + frame.linear * (origin - frame.a);
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
  Vector3 origin;               ///< in the middle of the source, so that the shifts lose few digits
  std::vector<int> mesh_faces;  ///< index in the source of each face with area
  FaceDistances distances;
  std::vector<FaceFrame> faces;  ///< in the order of `distances`
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

  const double no_area = 1e-14 * std::pow(diagonal(source.vertices), 2);  // as MeshFindings counts them
  std::vector<int> mesh_faces;
  std::vector<Matrix3> triangles;
  for (int face = 0; face < source.faces.cols(); ++face) {
    const Matrix3 triangle = corners(source, source.vertices, face);
    const Vector3 normal = (triangle.col(1) - triangle.col(0)).cross(triangle.col(2) - triangle.col(0));
    if (!(normal.norm() / 2 > no_area)) continue;
    mesh_faces.push_back(face);
    triangles.push_back(triangle);
  }
  if (triangles.empty()) throw InvalidInput("p-FFD: no face of the source has any area");

  const std::vector<int> used = referenced_vertices(source);
  const Points used_vertices = source.vertices(Eigen::all, used);
  const AffineMap affine = affine_fit(used_vertices, fitted(Eigen::all, used));
  Frames frames{affine, bounding_box(used_vertices).center(), mesh_faces, {triangles, lambda}, {}};
  for (const int place : frames.distances.order()) {
    const auto index = static_cast<std::size_t>(place);
    const Matrix3 image = corners(source, fitted, mesh_faces[index]);
    frames.faces.push_back(make_frame(triangles[index], image, affine, frames.origin));
  }
  frames_ = std::make_unique<const Frames>(std::move(frames));
}

PffdMap::~PffdMap() = default;

AffineMap PffdMap::affine() const { return frames_->affine; }

namespace {

using Neighbours = std::vector<FaceDistances::Near>;

/// The faces' maps at one point, blended: minus the background map, about the frames' origin.
struct Blend {
  Vector3 shift = Vector3::Zero();
  Matrix3 linear = Matrix3::Zero();
  double total_weight = 0;
  double nearest = 1;  ///< s of the nearest face

  /// A point on the surface up to rounding: the faces that touch it agree, and the weights have no limit.
  bool on_surface() const { return nearest <= 1e-18; }

  double weight(double area, double s) const {
    if (on_surface()) return s <= 1e-18 ? 1 : 0;
    // Relative to 1/s² of the nearest face, which stays finite near the surface.
    const double ratio = nearest / s, fade = 1 - s;
    return area * ratio * ratio * fade * fade * fade;
  }
};

Blend blend_faces(const std::vector<FaceFrame>& faces, const Neighbours& near, double lambda) {
  Blend blend;
  const double inverse = 1 / (lambda * lambda);
  for (const FaceDistances::Near& at : near)
    blend.nearest = std::min(blend.nearest, at.squared_distance * inverse);
  if (!blend.on_surface()) blend.total_weight = background * lambda * lambda * blend.nearest * blend.nearest;
  for (const FaceDistances::Near& at : near) {
    const FaceFrame& face = faces[static_cast<std::size_t>(at.place)];
    const double share = blend.weight(face.area, at.squared_distance * inverse);
    blend.shift += share * face.shift;
    blend.linear += share * face.linear;
    blend.total_weight += share;
  }
  blend.shift /= blend.total_weight;
  blend.linear /= blend.total_weight;
  return blend;
}

/// ∇u: the blended linear parts, and the change of the weights.
Matrix3 blend_gradient(const std::vector<FaceFrame>& faces, const Neighbours& near, const Vector3& x,
                       const Vector3& origin, double lambda) {
  const Blend blend = blend_faces(faces, near, lambda);
  if (blend.on_surface()) return blend.linear;
  const Vector3 displacement = blend.shift + blend.linear * (x - origin);
  Matrix3 change = Matrix3::Zero();
  for (const FaceDistances::Near& at : near) {
    const FaceFrame& face = faces[static_cast<std::size_t>(at.place)];
    const double s = at.squared_distance / (lambda * lambda);
    // d/ds (1 − s)³ / s² = −(1 − s)² (s + 2) / s³, and ∇s = 2 arm / λ².
    const double slope = -blend.weight(face.area, s) * (s + 2) / (s * (1 - s)) * 2 / (lambda * lambda);
    const Vector3 off = face.shift + face.linear * (x - origin) - displacement;
    change += slope * off * arm_from_face(face, x).transpose();
  }
  return blend.linear + change / blend.total_weight;
}

}  // namespace

template <class Take>
void PffdMap::for_each_neighbourhood(const Points& x, const Take& take) const {
  parallel_for(static_cast<std::size_t>(x.cols()), 32, [&](std::size_t begin, std::size_t end) {
    FaceDistances::Scratch scratch;
    for (std::size_t i = begin; i < end; ++i) {
      const auto column = static_cast<Eigen::Index>(i);
      const Vector3 at = x.col(column);
      if (const Neighbours& near = frames_->distances.find(at, scratch); !near.empty())
        take(column, near, at);
    }
  });
}

Points PffdMap::displacement(const Points& x) const {
  Points result = Points::Zero(3, x.cols());
  for_each_neighbourhood(x, [&](Eigen::Index i, const Neighbours& near, const Vector3& at) {
    const Blend blend = blend_faces(frames_->faces, near, lambda_);
    result.col(i) = blend.shift + blend.linear * (at - frames_->origin);
  });
  return result;
}

Points PffdMap::displacement_gradient(const Points& x) const {
  Points result = Points::Zero(3, 3 * x.cols());
  for_each_neighbourhood(x, [&](Eigen::Index i, const Neighbours& near, const Vector3& at) {
    result.middleCols<3>(3 * i) = blend_gradient(frames_->faces, near, at, frames_->origin, lambda_);
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
