#include "bespoke/topology/half_edge_mesh.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

#include "bespoke/error.h"
#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

bool is_manifold(const MeshEdge& edge) { return edge.forward <= 1 && edge.backward <= 1; }

/// Corner k of face f is 3 f + k. Corners at a vertex are joined across the edges that `is_closed` passes.
template <class IsClosed>
DisjointSets joined_corners(const TriangleMesh& mesh, const MeshEdges& edges, const IsClosed& is_closed) {
  DisjointSets corners(static_cast<int>(mesh.faces.size()));
  std::vector<int> first_side(edges.edges.size(), MeshEdges::none);  // 3 f + k of the side seen first
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k) {
      const int edge = edges.of_face(k, face);
      if (edge == MeshEdges::none || !is_closed(edge)) continue;
      int& other = first_side[static_cast<std::size_t>(edge)];
      const int face_number = static_cast<int>(face), side = 3 * face_number + k;
      if (other == MeshEdges::none) {
        other = side;
        continue;
      }
      // The other face runs through the edge the other way: its end is this one's beginning.
      const int other_end = 3 * (other / 3) + (other % 3 + 1) % 3;
      corners.join(side, other_end);
      corners.join(3 * face_number + (k + 1) % 3, other);
    }
  return corners;
}

/// Every set of corners becomes a vertex; the first set at a vertex keeps its number.
SplitMesh split_corners(const TriangleMesh& mesh, DisjointSets corners) {
  SplitMesh split{mesh, std::vector<int>(static_cast<std::size_t>(mesh.vertices.cols()))};
  std::iota(split.origins.begin(), split.origins.end(), 0);
  std::vector<char> is_taken(split.origins.size(), 0);
  std::vector<int> of_set(static_cast<std::size_t>(mesh.faces.size()), MeshEdges::none);
  for (Eigen::Index corner = 0; corner < mesh.faces.size(); ++corner) {
    int& vertex = split.mesh.faces.reshaped()[corner];
    int& number = of_set[static_cast<std::size_t>(corners.least(static_cast<int>(corner)))];
    if (number == MeshEdges::none) {
      char& taken = is_taken[static_cast<std::size_t>(vertex)];
      number = taken ? static_cast<int>(split.origins.size()) : vertex;
      if (taken) split.origins.push_back(vertex);
      taken = 1;
    }
    vertex = number;
  }
  split.mesh.vertices = mesh.vertices(Eigen::all, split.origins);
  return split;
}

void require_no_repeated_vertices(const NonManifoldPlaces& places) {
  if (!places.faces.empty()) throw InvalidInput(to_string({{}, {}, places.faces}) + "; remove them");
}

}  // namespace

NonManifoldPlaces non_manifold_places(const TriangleMesh& mesh) {
  NonManifoldPlaces places;
  const MeshEdges edges = mesh_edges(mesh);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    if ((edges.of_face.col(face).array() == MeshEdges::none).any())
      places.faces.push_back(static_cast<int>(face));
  std::vector<char> is_bad_end(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const MeshEdge& edge : edges.edges)
    if (!is_manifold(edge)) {
      places.edges.push_back({edge.a, edge.b});
      is_bad_end[static_cast<std::size_t>(edge.a)] = is_bad_end[static_cast<std::size_t>(edge.b)] = 1;
    }
  DisjointSets corners = joined_corners(
      mesh, edges, [&](int edge) { return is_manifold(edges.edges[static_cast<std::size_t>(edge)]); });
  std::vector<int> fans(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (Eigen::Index corner = 0; corner < mesh.faces.size(); ++corner)
    if (corners.least(static_cast<int>(corner)) == corner)
      ++fans[static_cast<std::size_t>(mesh.faces.reshaped()[corner])];
  for (std::size_t vertex = 0; vertex < fans.size(); ++vertex)
    if (fans[vertex] > 1 && !is_bad_end[vertex]) places.vertices.push_back(static_cast<int>(vertex));
  return places;
}

std::string to_string(const NonManifoldPlaces& places) {
  std::string text;
  const auto add = [&](std::size_t count, const char* one, const char* many, const std::string& first) {
    if (count == 0) return;
    text += text.empty() ? "" : ", ";
    text += std::to_string(count) + " " + (count == 1 ? one : many) + " (the first " + first + ")";
  };
  const auto number = [](int index) { return std::to_string(index + 1); };
  if (!places.edges.empty())
    add(places.edges.size(), "non-manifold edge", "non-manifold edges",
        "between vertices " + number(places.edges.front()[0]) + " and " + number(places.edges.front()[1]));
  if (!places.vertices.empty())
    add(places.vertices.size(), "non-manifold vertex", "non-manifold vertices",
        "is vertex " + number(places.vertices.front()));
  if (!places.faces.empty())
    add(places.faces.size(), "face that names a vertex twice", "faces that name a vertex twice",
        "is face " + number(places.faces.front()));
  return text;
}

HalfEdgeMesh half_edge_mesh(const TriangleMesh& mesh) {
  const NonManifoldPlaces places = non_manifold_places(mesh);
  if (!places.empty()) throw InvalidInput("the mesh is no manifold: " + to_string(places));
  HalfEdgeMesh result;
  result.reserve(static_cast<std::size_t>(mesh.vertices.cols()),
                 static_cast<std::size_t>(mesh.vertices.cols() + mesh.faces.cols()),
                 static_cast<std::size_t>(mesh.faces.cols()));
  for (const auto& x : mesh.vertices.colwise()) result.add_vertex({x.x(), x.y(), x.z()});
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    const auto corner = [&](int k) { return OpenMesh::VertexHandle(mesh.faces(k, face)); };
    if (!result.add_face(corner(0), corner(1), corner(2)).is_valid())
      throw InvalidInput("face " + std::to_string(face + 1) + " does not continue the surface around it");
  }
  return result;
}

TriangleMesh triangle_mesh(const HalfEdgeMesh& mesh) {
  std::vector<int> number(mesh.n_vertices(), MeshEdges::none);
  TriangleMesh result;
  result.vertices.resize(3, static_cast<Eigen::Index>(mesh.n_vertices()));
  Eigen::Index vertices = 0, faces = 0;
  for (const auto vertex : mesh.vertices()) {  // deleted ones are skipped
    const OpenMesh::Vec3d& x = mesh.point(vertex);
    result.vertices.col(vertices) = Vector3(x[0], x[1], x[2]);
    number[static_cast<std::size_t>(vertex.idx())] = static_cast<int>(vertices++);
  }
  result.vertices.conservativeResize(3, vertices);
  result.faces.resize(3, static_cast<Eigen::Index>(mesh.n_faces()));
  for (const auto face : mesh.faces()) {
    int corner = 0;
    for (const auto vertex : mesh.fv_range(face))
      result.faces(corner++, faces) = number[static_cast<std::size_t>(vertex.idx())];
    ++faces;
  }
  result.faces.conservativeResize(3, faces);
  return result;
}

SplitMesh split_to_manifold(const TriangleMesh& mesh) {
  require_no_repeated_vertices(non_manifold_places(mesh));
  const MeshEdges edges = mesh_edges(mesh);
  return split_corners(mesh, joined_corners(mesh, edges, [&](int edge) {
                         return is_manifold(edges.edges[static_cast<std::size_t>(edge)]);
                       }));
}

SplitMesh split_at_edges(const TriangleMesh& mesh, const std::vector<std::array<int, 2>>& cuts) {
  require_no_repeated_vertices(non_manifold_places(mesh));
  const MeshEdges edges = mesh_edges(mesh);
  std::vector<char> is_cut(edges.edges.size(), 0);
  for (const auto& [one, other] : cuts) {
    const std::pair ends(std::min(one, other), std::max(one, other));
    const auto found = std::lower_bound(
        edges.edges.begin(), edges.edges.end(), ends,
        [](const MeshEdge& edge, const auto& wanted) { return std::pair(edge.a, edge.b) < wanted; });
    if (found == edges.edges.end() || std::pair(found->a, found->b) != ends)
      throw InvalidInput("vertices " + std::to_string(one + 1) + " and " + std::to_string(other + 1) +
                         " share no edge, so no seam runs between them");
    is_cut[static_cast<std::size_t>(found - edges.edges.begin())] = 1;
  }
  return split_corners(mesh, joined_corners(mesh, edges, [&](int edge) {
                         const auto index = static_cast<std::size_t>(edge);
                         return !is_cut[index] && is_manifold(edges.edges[index]);
                       }));
}

std::vector<std::vector<int>> boundary_loops(const HalfEdgeMesh& mesh) {
  std::vector<std::vector<int>> loops;
  std::vector<char> is_seen(mesh.n_halfedges(), 0);
  for (const auto start : mesh.halfedges()) {
    if (!mesh.is_boundary(start) || is_seen[static_cast<std::size_t>(start.idx())]) continue;
    std::vector<int> loop;
    OpenMesh::HalfedgeHandle at = start;
    do {  // along the boundary's own half-edges the surface lies on the right
      is_seen[static_cast<std::size_t>(at.idx())] = 1;
      loop.push_back(mesh.from_vertex_handle(at).idx());
      at = mesh.next_halfedge_handle(at);
    } while (at != start);
    std::reverse(loop.begin(), loop.end());
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    loops.push_back(std::move(loop));
  }
  std::sort(loops.begin(), loops.end());
  return loops;
}

}  // namespace bespoke
