#include "bespoke/topology/decimation.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>

#include "bespoke/topology/half_edge_mesh.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

/// 3×n, of unit diagonal about the origin: the library takes floats.
Eigen::Matrix3Xf normalised(const Points& vertices) {
  const Box box = bounding_box(vertices);
  const double extent = box.diagonal().norm();
  return ((vertices.colwise() - box.center()) / (extent > 0 ? extent : 1)).cast<float>();
}

std::vector<unsigned> corners_without_repeated_vertices(const Faces& faces) {
  std::vector<unsigned> corners;
  for (const auto& face : faces.colwise())
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0])
      for (const int vertex : face) corners.push_back(static_cast<unsigned>(vertex));
  return corners;
}

using Corner = OpenMesh::Vec3d;

/// Cosine and sine, times the same length, of the angle at `apex`.
struct Angle {
  double cosine, sine;
  Angle(const Corner& apex, const Corner& a, const Corner& b)
      : cosine((a - apex) | (b - apex)), sine(((a - apex) % (b - apex)).norm()) {}
};

/// The four corners around an edge between a and b; c and d are opposite.
struct Quad {
  Corner a, b, c, d;

  Quad(const HalfEdgeMesh& mesh, OpenMesh::EdgeHandle edge) {
    const auto half = mesh.halfedge_handle(edge, 0), other = mesh.halfedge_handle(edge, 1);
    a = mesh.point(mesh.from_vertex_handle(half));
    b = mesh.point(mesh.to_vertex_handle(half));
    c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(half)));
    d = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(other)));
  }
  /// Whether the angles at c and d are more than half a turn together: the other diagonal is Delaunay's.
  bool is_long() const {
    const Angle at_c(c, a, b), at_d(d, b, a);
    return at_c.sine * at_d.cosine + at_c.cosine * at_d.sine <
           -1e-9 * (at_c.sine + at_d.sine) * (std::abs(at_c.cosine) + std::abs(at_d.cosine));
  }
  /// Whether all four faces that may lie between the corners face one way, slivers apart.
  bool is_flat() const {
    constexpr double min_cosine = 0.98, sliver = 0.01;
    const double squared_length = (b - a).sqrnorm();
    const Corner normals[] = {(b - a) % (c - a), (a - b) % (d - b), (d - c) % (b - c), (c - d) % (a - d)};
    const Corner mean = normals[0] + normals[1];
    for (const Corner& normal : normals)
      if (normal.norm() > sliver * squared_length &&
          (normal | mean) < min_cosine * normal.norm() * mean.norm())
        return false;
    return true;
  }
};

/// Without slivers where the surface is flat, on which quadrics tell no place from another.
void flip_to_delaunay(HalfEdgeMesh& mesh) {
  std::vector<OpenMesh::EdgeHandle> waiting(mesh.edges_begin(), mesh.edges_end());
  std::size_t left = 20 * waiting.size();  // rounding must not flip for ever
  while (!waiting.empty() && left-- > 0) {
    const auto edge = waiting.back();
    waiting.pop_back();
    if (mesh.is_boundary(edge)) continue;
    const Quad quad(mesh, edge);
    if (!quad.is_long() || !quad.is_flat() || !mesh.is_flip_ok(edge)) continue;
    mesh.flip(edge);
    for (const auto half : {mesh.halfedge_handle(edge, 0), mesh.halfedge_handle(edge, 1)})
      for (const auto side : {mesh.next_halfedge_handle(half), mesh.prev_halfedge_handle(half)})
        waiting.push_back(mesh.edge_handle(side));
  }
}

/// The faces of the mesh, whose vertices keep their numbers, with flipped edges.
Faces delaunay(const TriangleMesh& mesh) {
  const SplitMesh split = split_to_manifold(mesh);
  HalfEdgeMesh topology = half_edge_mesh(split.mesh);
  flip_to_delaunay(topology);
  Faces faces = triangle_mesh(topology).faces;
  for (int& vertex : faces.reshaped()) vertex = split.origins[static_cast<std::size_t>(vertex)];
  return faces;
}

/// The mesh of these faces, whose corners are numbers of `whole`'s vertices.
DecimatedMesh part_of(const TriangleMesh& whole, std::vector<int> corners) {
  DecimatedMesh result;
  result.vertices = corners;
  std::sort(result.vertices.begin(), result.vertices.end());
  result.vertices.erase(std::unique(result.vertices.begin(), result.vertices.end()), result.vertices.end());
  for (int& vertex : corners)
    vertex = static_cast<int>(std::lower_bound(result.vertices.begin(), result.vertices.end(), vertex) -
                              result.vertices.begin());
  result.mesh.vertices = whole.vertices(Eigen::all, result.vertices);
  result.mesh.faces =
      Eigen::Map<const Faces>(corners.data(), 3, static_cast<Eigen::Index>(corners.size()) / 3);
  return result;
}

}  // namespace

DecimatedMesh decimated(const TriangleMesh& mesh, std::size_t max_faces) {
  constexpr float max_error = 0.05F;  // of the extent: larger parts do not vanish
  const JoinedMesh joined = joined_at_seams(mesh);
  const Eigen::Matrix3Xf places = normalised(joined.mesh.vertices);
  std::vector<unsigned> corners = corners_without_repeated_vertices(joined.mesh.faces);
  if (corners.size() > 3 * max_faces)
    corners.resize(meshopt_simplify(corners.data(), corners.data(), corners.size(), places.data(),
                                    static_cast<std::size_t>(places.cols()), 3 * sizeof(float), 3 * max_faces,
                                    max_error));
  std::vector<int> whole;
  for (const unsigned corner : corners) whole.push_back(joined.first[corner]);
  DecimatedMesh fewer = part_of(mesh, std::move(whole));
  fewer.mesh.faces = delaunay(fewer.mesh);
  return fewer;
}

}  // namespace bespoke
