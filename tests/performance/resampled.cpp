#include "resampled.h"

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <string>
#include <vector>

#include "bespoke/error.h"
#include "bespoke/mesh/edge_refinement.h"

namespace bespoke {
namespace {

namespace om = OpenMesh;

struct DoubleTraits : om::DefaultTraits {
  using Point = om::Vec3d;
  using Normal = om::Vec3d;
};
using Mesh = om::TriMesh_ArrayKernelT<DoubleTraits>;

Mesh to_openmesh(const TriangleMesh& mesh) {
  Mesh result;
  std::vector<om::VertexHandle> vertices;
  for (const auto& x : mesh.vertices.colwise()) vertices.push_back(result.add_vertex({x.x(), x.y(), x.z()}));
  for (const auto& face : mesh.faces.colwise())
    if (!result
             .add_face(vertices[static_cast<std::size_t>(face[0])],
                       vertices[static_cast<std::size_t>(face[1])],
                       vertices[static_cast<std::size_t>(face[2])])
             .is_valid())
      throw InvalidInput("a mesh that is not manifold cannot be resampled");
  return result;
}

TriangleMesh from_openmesh(const Mesh& mesh) {
  TriangleMesh result;
  result.vertices.resize(3, static_cast<Eigen::Index>(mesh.n_vertices()));
  for (const om::VertexHandle vertex : mesh.vertices())
    for (int axis = 0; axis < 3; ++axis)
      result.vertices(axis, vertex.idx()) = mesh.point(vertex)[static_cast<std::size_t>(axis)];
  result.faces.resize(3, static_cast<Eigen::Index>(mesh.n_faces()));
  for (const om::FaceHandle face : mesh.faces()) {
    int corner = 0;
    for (const om::VertexHandle vertex : mesh.fv_range(face))
      result.faces(corner++, face.idx()) = vertex.idx();
  }
  return result;
}

}  // namespace

TriangleMesh resampled(const TriangleMesh& mesh, Eigen::Index vertices) {
  TriangleMesh fine = mesh;
  while (fine.vertices.cols() < vertices) {
    const double every_edge = 1e-9 * diagonal(fine.vertices);
    fine = refine_long_edges(fine, every_edge, 1).mesh;
  }
  Mesh collapsed = to_openmesh(fine);
  collapsed.request_face_normals();
  collapsed.update_face_normals();
  om::Decimater::DecimaterT<Mesh> decimater(collapsed);
  om::Decimater::ModQuadricT<Mesh>::Handle quadric;
  decimater.add(quadric);
  decimater.module(quadric).unset_max_err();
  om::Decimater::ModNormalFlippingT<Mesh>::Handle flipping;
  decimater.add(flipping);
  decimater.initialize();
  decimater.decimate_to(static_cast<std::size_t>(vertices));
  collapsed.garbage_collection();
  return from_openmesh(collapsed);
}

}  // namespace bespoke
