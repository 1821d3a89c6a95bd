#include "bespoke/elastic/detail/face_frames.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bespoke/elastic/detail/exact_map_bytes.h"
#include "bespoke/error.h"
#include "bespoke/rigid/affine_alignment.h"

namespace bespoke {
namespace {

/// Vertices that some face uses; the others say nothing about the shape.
std::vector<int> referenced_vertices(const TriangleMesh& mesh) {
  std::vector<char> used(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (Eigen::Index i = 0; i < mesh.faces.size(); ++i) used[static_cast<std::size_t>(mesh.faces(i))] = 1;
  std::vector<int> result;
  for (std::size_t i = 0; i < used.size(); ++i)
    if (used[i]) result.push_back(static_cast<int>(i));
  return result;
}

Matrix3 corners(const TriangleMesh& mesh, const Points& vertices, Eigen::Index face) {
  Matrix3 result;
  for (int corner = 0; corner < 3; ++corner) result.col(corner) = vertices.col(mesh.faces(corner, face));
  return result;
}

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

void require_usable(const TriangleMesh& source, const Points& fitted, double lambda) {
  require_valid(source, "source of the p-FFD");
  if (fitted.cols() != source.vertices.cols())
    throw InvalidInput("p-FFD: " + std::to_string(source.vertices.cols()) + " source vertices, but " +
                       std::to_string(fitted.cols()) + " fitted ones");
  if (!fitted.allFinite()) throw InvalidInput("p-FFD: a fitted vertex is not finite");
  if (!(lambda > 0 && std::isfinite(lambda)))
    throw InvalidInput("p-FFD: lambda is " + std::to_string(lambda) + ", but must be finite and above 0");
}

}  // namespace

FaceFrames face_frames(const TriangleMesh& source, const Points& fitted, double lambda) {
  require_usable(source, fitted, lambda);
  const double no_area = 1e-14 * std::pow(diagonal(source.vertices), 2);  // as MeshFindings counts them
  FaceFrames frames;
  for (int face = 0; face < source.faces.cols(); ++face) {
    const Matrix3 triangle = corners(source, source.vertices, face);
    const Vector3 normal = (triangle.col(1) - triangle.col(0)).cross(triangle.col(2) - triangle.col(0));
    if (!(normal.norm() / 2 > no_area)) continue;
    frames.mesh_faces.push_back(face);
    frames.triangles.push_back(triangle);
  }
  if (frames.triangles.empty()) throw InvalidInput("p-FFD: no face of the source has any area");

  const std::vector<int> used = referenced_vertices(source);
  const Points used_vertices = source.vertices(Eigen::all, used);
  frames.affine = align_affinely(used_vertices, fitted(Eigen::all, used), FlatDirections::of_rounding);
  frames.origin = bounding_box(used_vertices).center();
  for (std::size_t i = 0; i < frames.triangles.size(); ++i)
    frames.frames.push_back(make_frame(frames.triangles[i], corners(source, fitted, frames.mesh_faces[i]),
                                       frames.affine, frames.origin));
  return frames;
}

Support support_around(const TriangleMesh& mesh, const std::vector<int>& faces, double lambda) {
  // One ball per place; an eighth of λ keeps their number low and the excess of the band small.
  const double spacing = lambda / 8;
  const std::vector<Vector3> places = cover(mesh, faces, spacing);
  Support support;
  support.clouds.push_back(
      {Points::Map(places.front().data(), 3, static_cast<int>(places.size())), lambda + spacing});
  return support;
}

void write_face_map(const TriangleMesh& source, const Points& fitted, double lambda, ExactMapWriter& writer) {
  writer.number(lambda);
  writer.points(source.vertices);
  writer.points(fitted);
  writer.count(source.faces.cols());
  for (Eigen::Index i = 0; i < source.faces.size(); ++i)
    writer.integer(static_cast<std::uint32_t>(source.faces(i)));
}

FaceMap read_face_map(ExactMapReader& reader) {
  FaceMap map;
  map.lambda = reader.positive("lambda");
  map.source.vertices = reader.points("source vertices");
  map.fitted = reader.points("fitted vertices");
  map.source.faces.resize(3, reader.count(3 * sizeof(std::uint32_t), "faces"));
  for (Eigen::Index i = 0; i < map.source.faces.size(); ++i) {
    const auto vertex = reader.integer<std::uint32_t>();
    if (!(vertex < map.source.vertices.cols()))
      reject_exact_map("a face uses vertex " + std::to_string(vertex));
    map.source.faces(i) = static_cast<int>(vertex);
  }
  reader.end();
  return map;
}

}  // namespace bespoke
