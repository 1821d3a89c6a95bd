#include "bespoke/elastic/pffd_smooth.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "bespoke/elastic/detail/face_distances.h"
#include "bespoke/elastic/detail/face_frames.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

/// Weight of the affine part against the faces', as a fraction of the area πλ² of the disc that a plane shows
/// to a point on it: small, so that the faces rule up to three quarters of λ, positive, so that they fade
/// out.
constexpr double background = 0.1 * 3.14159265358979323846;

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

}  // namespace

struct SmoothPffdMap::Frames {
  FaceFrames source;
  FaceDistances distances;
  std::vector<FaceFrame> faces;  ///< in the order of `distances`
};

SmoothPffdMap::SmoothPffdMap(const TriangleMesh& source, const Points& fitted, double lambda)
    : source_(source), fitted_(fitted), lambda_(lambda) {
  FaceFrames frames = face_frames(source, fitted, lambda);
  FaceDistances distances(frames.triangles, lambda);
  std::vector<FaceFrame> faces;
  for (const int place : distances.order()) faces.push_back(frames.frames[static_cast<std::size_t>(place)]);
  frames_ = std::make_unique<const Frames>(Frames{std::move(frames), std::move(distances), std::move(faces)});
}

SmoothPffdMap::~SmoothPffdMap() = default;

AffineMap SmoothPffdMap::affine() const { return frames_->source.affine; }

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
void SmoothPffdMap::for_each_neighbourhood(const Points& x, const Take& take) const {
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

Points SmoothPffdMap::displacement(const Points& x) const {
  Points result = Points::Zero(3, x.cols());
  for_each_neighbourhood(x, [&](Eigen::Index i, const Neighbours& near, const Vector3& at) {
    const Blend blend = blend_faces(frames_->faces, near, lambda_);
    result.col(i) = blend.shift + blend.linear * (at - frames_->source.origin);
  });
  return result;
}

Points SmoothPffdMap::displacement_gradient(const Points& x) const {
  Points result = Points::Zero(3, 3 * x.cols());
  for_each_neighbourhood(x, [&](Eigen::Index i, const Neighbours& near, const Vector3& at) {
    result.middleCols<3>(3 * i) = blend_gradient(frames_->faces, near, at, frames_->source.origin, lambda_);
  });
  return result;
}

Support SmoothPffdMap::support() const {
  return support_around(source_, frames_->source.mesh_faces, lambda_);
}

void write_exact(const SmoothPffdMap& map, ExactMapWriter& writer) {
  write_face_map(map.source(), map.fitted(), map.lambda(), writer);
}

std::shared_ptr<const SmoothPffdMap> read_pffd_smooth(ExactMapReader& reader) {
  const FaceMap map = read_face_map(reader);
  return std::make_shared<SmoothPffdMap>(map.source, map.fitted, map.lambda);
}

}  // namespace bespoke
