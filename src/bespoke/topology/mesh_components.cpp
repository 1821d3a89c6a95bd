#include "bespoke/topology/mesh_components.h"

#include "bespoke/mesh/disjoint_sets.h"

namespace bespoke {

MeshComponents mesh_components(const TriangleMesh& mesh) {
  const auto count = static_cast<std::size_t>(mesh.vertices.cols());
  DisjointSets sets(static_cast<int>(count));
  std::vector<char> is_used(count, 0);
  for (const auto& face : mesh.faces.colwise())
    for (const int vertex : face) {
      is_used[static_cast<std::size_t>(vertex)] = 1;
      sets.join(face[0], vertex);
    }
  MeshComponents components;
  components.of_vertex.assign(count, MeshComponents::none);
  for (std::size_t vertex = 0; vertex < count; ++vertex) {
    if (!is_used[vertex]) continue;
    // The least vertex comes first and opens the component.
    const auto least = static_cast<std::size_t>(sets.least(static_cast<int>(vertex)));
    if (least == vertex) {
      components.of_vertex[vertex] = components.count();
      components.vertices.push_back(0);
      components.faces.push_back(0);
    }
    components.of_vertex[vertex] = components.of_vertex[least];
    ++components.vertices[static_cast<std::size_t>(components.of_vertex[vertex])];
  }
  for (const auto& face : mesh.faces.colwise()) {
    components.of_face.push_back(components.of_vertex[static_cast<std::size_t>(face[0])]);
    ++components.faces[static_cast<std::size_t>(components.of_face.back())];
  }
  return components;
}

PartialMesh kept_components(const TriangleMesh& mesh, const MeshComponents& components,
                            const std::vector<char>& is_kept) {
  const auto keeps = [&](int component) {
    return component != MeshComponents::none && is_kept[static_cast<std::size_t>(component)];
  };
  PartialMesh part;
  std::vector<int> number(components.of_vertex.size(), 0);
  for (std::size_t vertex = 0; vertex < number.size(); ++vertex) {
    if (!keeps(components.of_vertex[vertex])) continue;
    number[vertex] = static_cast<int>(part.vertices.size());
    part.vertices.push_back(static_cast<int>(vertex));
  }
  std::vector<Eigen::Index> faces;
  for (std::size_t face = 0; face < components.of_face.size(); ++face)
    if (keeps(components.of_face[face])) faces.push_back(static_cast<Eigen::Index>(face));
  part.mesh.vertices = mesh.vertices(Eigen::all, part.vertices);
  part.mesh.faces = mesh.faces(Eigen::all, faces);
  for (int& vertex : part.mesh.faces.reshaped()) vertex = number[static_cast<std::size_t>(vertex)];
  return part;
}

}  // namespace bespoke
