#include "bespoke/topology/decimation.h"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>

#include "bespoke/topology/half_edge_mesh.h"
#include "bespoke/topology/seams.h"

namespace bespoke {
namespace {

namespace decimater = OpenMesh::Decimater;
using Quadric = OpenMesh::Geometry::Quadricd;

/// OpenMesh's quadrics are of faces alone, so that a flat sheet would lose its outline: here every boundary
/// edge adds the plane through it that is perpendicular to its face.
template <class MeshT>
class BoundedQuadrics : public decimater::ModQuadricT<MeshT> {
 public:
  DECIMATING_MODULE(BoundedQuadrics, MeshT, BoundedQuadrics)
  using OfFaces = decimater::ModQuadricT<MeshT>;

  explicit BoundedQuadrics(Mesh& mesh) : OfFaces(mesh) { mesh.add_property(of_boundary_); }
  ~BoundedQuadrics() override { OfFaces::mesh().remove_property(of_boundary_); }

  void initialize() override {
    OfFaces::initialize();
    Mesh& mesh = OfFaces::mesh();
    for (const auto vertex : mesh.vertices()) mesh.property(of_boundary_, vertex).clear();
    for (const auto edge : mesh.halfedges()) {
      if (!mesh.is_boundary(edge)) continue;
      const OpenMesh::Vec3d along = mesh.calc_edge_vector(edge);
      const OpenMesh::Vec3d normal = along % mesh.normal(mesh.opposite_face_handle(edge));
      // Of this length squared: the plane's weight is that of a face as wide as the edge is long.
      const double offset = -(normal | mesh.point(mesh.from_vertex_handle(edge)));
      const Quadric plane(normal[0], normal[1], normal[2], offset);
      mesh.property(of_boundary_, mesh.from_vertex_handle(edge)) += plane;
      mesh.property(of_boundary_, mesh.to_vertex_handle(edge)) += plane;
    }
  }

  float collapse_priority(const CollapseInfo& collapse) override {
    Quadric boundary = OfFaces::mesh().property(of_boundary_, collapse.v0);
    boundary += OfFaces::mesh().property(of_boundary_, collapse.v1);
    const float faces = OfFaces::collapse_priority(collapse);
    // Rounding makes the error of a flat place negative, which would forbid the collapse.
    return std::max(0.0f, faces + static_cast<float>(boundary(collapse.p1)));
  }

  void postprocess_collapse(const CollapseInfo& collapse) override {
    OfFaces::postprocess_collapse(collapse);
    OfFaces::mesh().property(of_boundary_, collapse.v1) +=
        OfFaces::mesh().property(of_boundary_, collapse.v0);
  }

 private:
  OpenMesh::VPropHandleT<Quadric> of_boundary_;
};

/// Of unit diagonal about the origin: priorities are floats.
TriangleMesh normalised(const TriangleMesh& mesh) {
  TriangleMesh result = mesh;
  const Box box = bounding_box(mesh.vertices);
  const double extent = box.diagonal().norm();
  result.vertices.colwise() -= box.center();
  if (extent > 0) result.vertices /= extent;
  return result;
}

TriangleMesh without_repeated_vertices(const TriangleMesh& mesh) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const auto face = mesh.faces.col(f);
    if (face[0] != face[1] && face[1] != face[2] && face[2] != face[0]) kept.push_back(f);
  }
  return {mesh.vertices, mesh.faces(Eigen::all, kept)};
}

/// `whole[v]`: the number of vertex v in the whole, several v may have the same.
DecimatedMesh renumbered(const TriangleMesh& whole_mesh, Faces faces, const std::vector<int>& whole) {
  DecimatedMesh result;
  for (int& vertex : faces.reshaped()) {
    vertex = whole[static_cast<std::size_t>(vertex)];
    result.vertices.push_back(vertex);
  }
  std::sort(result.vertices.begin(), result.vertices.end());
  result.vertices.erase(std::unique(result.vertices.begin(), result.vertices.end()), result.vertices.end());
  for (int& vertex : faces.reshaped())
    vertex = static_cast<int>(std::lower_bound(result.vertices.begin(), result.vertices.end(), vertex) -
                              result.vertices.begin());
  result.mesh = {whole_mesh.vertices(Eigen::all, result.vertices), std::move(faces)};
  return result;
}

void collapse_edges(HalfEdgeMesh& mesh, const DecimationOptions& options) {
  mesh.request_face_normals();
  mesh.update_face_normals();
  decimater::DecimaterT<HalfEdgeMesh> collapsing(mesh);
  BoundedQuadrics<HalfEdgeMesh>::Handle quadrics;
  decimater::ModNormalFlippingT<HalfEdgeMesh>::Handle flipping;
  collapsing.add(quadrics);
  collapsing.add(flipping);
  collapsing.initialize();
  collapsing.decimate_to_faces(options.max_vertices, options.max_faces);
}

}  // namespace

DecimatedMesh decimated(const TriangleMesh& mesh, const DecimationOptions& options) {
  const JoinedMesh joined = joined_at_seams(mesh);
  const SplitMesh split = split_to_manifold(without_repeated_vertices(joined.mesh));
  HalfEdgeMesh topology = half_edge_mesh(normalised(split.mesh));
  topology.request_vertex_status();
  topology.request_edge_status();
  topology.request_face_status();
  std::vector<int> copies(static_cast<std::size_t>(joined.mesh.vertices.cols()), 0);
  for (const int origin : split.origins) ++copies[static_cast<std::size_t>(origin)];
  for (const auto vertex : topology.vertices()) {
    const int origin = split.origins[static_cast<std::size_t>(vertex.idx())];
    topology.status(vertex).set_locked(copies[static_cast<std::size_t>(origin)] > 1);
  }
  collapse_edges(topology, options);

  std::vector<int> whole;
  for (const int origin : split.origins) whole.push_back(joined.first[static_cast<std::size_t>(origin)]);
  Faces faces(3, std::distance(topology.faces_sbegin(), topology.faces_end()));
  Eigen::Index next = 0;
  for (const auto face : topology.faces()) {  // deleted ones are skipped
    int corner = 0;
    for (const auto vertex : topology.fv_range(face)) faces(corner++, next) = vertex.idx();
    ++next;
  }
  return renumbered(mesh, std::move(faces), whole);
}

}  // namespace bespoke
