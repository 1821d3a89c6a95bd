#include "bespoke/mesh/triangle_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "bespoke/error.h"
#include "bespoke/parallel.h"
#include "bespoke/sha256.h"

namespace bespoke {
namespace {

// Below this share of the squared longest edge, twice the area is rounding noise of the cross product.
constexpr double relative_area_noise = 1e-14;

struct Edge {
  int a;  ///< a < b
  int b;
  int forward;   ///< faces that run from a to b
  int backward;  ///< faces that run from b to a
  int faces() const { return forward + backward; }
};

/// In parallel: visit(face) may write what is that face's alone.
template <class Visit>
void for_each_face(const TriangleMesh& mesh, const Visit& visit) {
  constexpr std::size_t grain = 1024;
  parallel_for(static_cast<std::size_t>(mesh.faces.cols()), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t face = begin; face < end; ++face) visit(static_cast<Eigen::Index>(face));
  });
}

bool has_three_vertices(const Faces& faces, Eigen::Index face) {
  return faces(0, face) != faces(1, face) && faces(1, face) != faces(2, face) &&
         faces(2, face) != faces(0, face);
}

// Faces that name a vertex twice have no edges of their own.
template <class Visit>
void for_each_half_edge(const TriangleMesh& mesh, const Visit& visit) {
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    if (!has_three_vertices(mesh.faces, face)) continue;
    for (int corner = 0; corner < 3; ++corner)
      visit(mesh.faces(corner, face), mesh.faces((corner + 1) % 3, face));
  }
}

// Sorted by (a, b). Bucketing by the smaller vertex keeps the cost linear.
std::vector<Edge> collect_edges(const TriangleMesh& mesh) {
  struct HalfEdge {
    int larger;
    bool forward;
  };
  std::vector<std::size_t> start(static_cast<std::size_t>(mesh.vertices.cols()) + 1, 0);
  for_each_half_edge(mesh,
                     [&](int from, int to) { ++start[static_cast<std::size_t>(std::min(from, to)) + 1]; });
  std::partial_sum(start.begin(), start.end(), start.begin());
  std::vector<HalfEdge> half_edges(start.back());
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  for_each_half_edge(mesh, [&](int from, int to) {
    half_edges[next[static_cast<std::size_t>(std::min(from, to))]++] = {std::max(from, to), from < to};
  });
  std::vector<Edge> edges;
  edges.reserve(half_edges.size() / 2);
  for (std::size_t vertex = 0; vertex + 1 < start.size(); ++vertex) {
    const auto begin = half_edges.begin() + static_cast<std::ptrdiff_t>(start[vertex]);
    const auto end = half_edges.begin() + static_cast<std::ptrdiff_t>(start[vertex + 1]);
    std::sort(begin, end, [](const HalfEdge& x, const HalfEdge& y) { return x.larger < y.larger; });
    for (auto half_edge = begin; half_edge != end; ++half_edge) {
      if (half_edge == begin || half_edge->larger != edges.back().b)
        edges.push_back({static_cast<int>(vertex), half_edge->larger, 0, 0});
      ++(half_edge->forward ? edges.back().forward : edges.back().backward);
    }
  }
  return edges;
}

std::size_t count_components(const TriangleMesh& mesh, const std::vector<char>& referenced) {
  std::vector<int> parent(referenced.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int vertex) {
    while (parent[static_cast<std::size_t>(vertex)] != vertex) {
      int& up = parent[static_cast<std::size_t>(vertex)];
      up = parent[static_cast<std::size_t>(up)];
      vertex = up;
    }
    return vertex;
  };
  auto components = static_cast<std::size_t>(std::count(referenced.begin(), referenced.end(), 1));
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face) {
    for (int corner = 1; corner < 3; ++corner) {
      const int a = root(mesh.faces(0, face)), b = root(mesh.faces(corner, face));
      if (a == b) continue;
      parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
      --components;
    }
  }
  return components;
}

std::size_t count_duplicates(const Points& vertices) {
  std::vector<std::array<double, 3>> finite;
  finite.reserve(static_cast<std::size_t>(vertices.cols()));
  for (Eigen::Index i = 0; i < vertices.cols(); ++i)
    if (vertices.col(i).allFinite()) finite.push_back({vertices(0, i), vertices(1, i), vertices(2, i)});
  std::sort(finite.begin(), finite.end());
  return finite.size() - static_cast<std::size_t>(std::unique(finite.begin(), finite.end()) - finite.begin());
}

// Twice the area as a vector.
Vector3 area_vector(const TriangleMesh& mesh, Eigen::Index face) {
  const Vector3 a = mesh.vertices.col(mesh.faces(0, face));
  const Vector3 ab = mesh.vertices.col(mesh.faces(1, face)) - a;
  const Vector3 ac = mesh.vertices.col(mesh.faces(2, face)) - a;
  return ab.cross(ac);
}

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + ' ' + (count == 1 ? one : many);
}

}  // namespace

MeshFindings inspect_mesh(const TriangleMesh& mesh) {
  const Eigen::Index vertices = mesh.vertices.cols();
  if (mesh.faces.size() > 0 && !(mesh.faces.minCoeff() >= 0 && mesh.faces.maxCoeff() < vertices))
    throw InvalidInput("a face names a vertex outside 0 … " + std::to_string(vertices - 1));
  MeshFindings findings;
  findings.vertices = static_cast<std::size_t>(vertices);
  findings.faces = static_cast<std::size_t>(mesh.faces.cols());
  std::vector<char> referenced(findings.vertices, 0);
  for (const int vertex : mesh.faces.reshaped()) referenced[static_cast<std::size_t>(vertex)] = 1;
  findings.unreferenced_vertices =
      static_cast<std::size_t>(std::count(referenced.begin(), referenced.end(), 0));
  findings.components = count_components(mesh, referenced);
  findings.duplicate_vertices = count_duplicates(mesh.vertices);
  for (const Edge& edge : collect_edges(mesh)) {
    findings.boundary_edges += edge.faces() == 1;
    findings.non_manifold_edges += edge.faces() > 2;
    findings.inconsistent_edges += edge.forward > 1 || edge.backward > 1;
  }
  const double extent = diagonal(mesh.vertices);
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    findings.degenerate_faces += !(area_vector(mesh, face).norm() / 2 > 1e-14 * extent * extent);
  return findings;
}

std::string to_string(const MeshFindings& findings) {
  std::string line = counted(findings.vertices, "vertex", "vertices") + ", " +
                     counted(findings.faces, "face", "faces") + ", " +
                     counted(findings.components, "component", "components");
  const auto add = [&](std::size_t count, const char* one, const char* many) {
    if (count > 0) line += ", " + counted(count, one, many);
  };
  if (findings.faces > 0 && findings.boundary_edges == 0) line += ", closed";
  add(findings.boundary_edges, "boundary edge", "boundary edges");
  add(findings.non_manifold_edges, "non-manifold edge", "non-manifold edges");
  add(findings.inconsistent_edges, "inconsistently oriented edge", "inconsistently oriented edges");
  add(findings.degenerate_faces, "face without area", "faces without area");
  add(findings.unreferenced_vertices, "vertex in no face", "vertices in no face");
  add(findings.duplicate_vertices, "duplicate vertex", "duplicate vertices");
  return line;
}

void require_valid(const TriangleMesh& mesh, const std::string& what) {
  const Eigen::Index vertices = mesh.vertices.cols();
  if (mesh.faces.cols() == 0) throw InvalidInput(what + " has no faces");
  for (Eigen::Index i = 0; i < vertices; ++i)
    if (!mesh.vertices.col(i).allFinite())
      throw InvalidInput(what + ": vertex " + std::to_string(i) + " has a coordinate that is not finite");
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (const int vertex : mesh.faces.col(face))
      if (!(vertex >= 0 && vertex < vertices))
        throw InvalidInput(what + ": face " + std::to_string(face) + " names vertex " +
                           std::to_string(vertex) + " of " + std::to_string(vertices));
  const double extent = diagonal(mesh.vertices);
  if (!(extent > 0)) throw InvalidInput(what + ": all vertices lie at one point");
  if (!std::isfinite(extent)) throw InvalidInput(what + ": coordinates are too large to compute with");
}

Box bounding_box(const Points& points) {
  Box box;
  for (Eigen::Index i = 0; i < points.cols(); ++i) box.extend(points.col(i));
  return box;
}

double diagonal(const Points& points) {
  return points.cols() == 0 ? 0 : bounding_box(points).diagonal().norm();
}

Points face_normals(const TriangleMesh& mesh) {
  Points normals(3, mesh.faces.cols());
  for_each_face(mesh, [&](Eigen::Index face) {
    const auto corner = [&](int k) { return mesh.vertices.col(mesh.faces(k, face)); };
    const double longest =
        std::max({(corner(1) - corner(0)).squaredNorm(), (corner(2) - corner(1)).squaredNorm(),
                  (corner(0) - corner(2)).squaredNorm()});
    const Vector3 area = area_vector(mesh, face);
    if (area.norm() > relative_area_noise * longest)
      normals.col(face) = area.stableNormalized();
    else
      normals.col(face).setZero();
  });
  return normals;
}

Points vertex_normals(const TriangleMesh& mesh) {
  const Points of_faces = face_normals(mesh);
  Points corner_angles(3, mesh.faces.cols());  // 0 where the face has no area
  for_each_face(mesh, [&](Eigen::Index face) {
    for (int k = 0; k < 3; ++k) {
      const auto vertex = mesh.vertices.col(mesh.faces(k, face));
      const Vector3 to_next = mesh.vertices.col(mesh.faces((k + 1) % 3, face)) - vertex;
      const Vector3 to_last = mesh.vertices.col(mesh.faces((k + 2) % 3, face)) - vertex;
      corner_angles(k, face) =
          of_faces.col(face).isZero(0) ? 0 : std::atan2(to_next.cross(to_last).norm(), to_next.dot(to_last));
    }
  });
  Points normals = Points::Zero(3, mesh.vertices.cols());
  Eigen::VectorXd angles = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int k = 0; k < 3; ++k) {
      normals.col(mesh.faces(k, face)) += corner_angles(k, face) * of_faces.col(face);
      angles(mesh.faces(k, face)) += corner_angles(k, face);
    }
  // Faces that face each other cancel up to rounding, which must not pass for a direction.
  for (Eigen::Index vertex = 0; vertex < normals.cols(); ++vertex) {
    if (normals.col(vertex).norm() > 1e-12 * angles(vertex))
      normals.col(vertex).normalize();
    else
      normals.col(vertex).setZero();
  }
  return normals;
}

VertexAdjacency vertex_adjacency(const TriangleMesh& mesh) {
  const std::vector<Edge> edges = collect_edges(mesh);
  VertexAdjacency adjacency;
  adjacency.start.assign(static_cast<std::size_t>(mesh.vertices.cols()) + 1, 0);
  for (const Edge& edge : edges) {
    ++adjacency.start[static_cast<std::size_t>(edge.a) + 1];
    ++adjacency.start[static_cast<std::size_t>(edge.b) + 1];
  }
  std::partial_sum(adjacency.start.begin(), adjacency.start.end(), adjacency.start.begin());
  adjacency.neighbours.resize(2 * edges.size());
  std::vector<int> next(adjacency.start.begin(), adjacency.start.end() - 1);
  const auto add = [&](int vertex, int neighbour) {
    adjacency.neighbours[static_cast<std::size_t>(next[static_cast<std::size_t>(vertex)]++)] = neighbour;
  };
  // Edges come sorted, so smaller neighbours first, then larger ones, fills every list in order.
  for (const Edge& edge : edges) add(edge.b, edge.a);
  for (const Edge& edge : edges) add(edge.a, edge.b);
  return adjacency;
}

std::vector<char> boundary_vertices(const TriangleMesh& mesh) {
  std::vector<char> on_boundary(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const Edge& edge : collect_edges(mesh)) {
    if (edge.faces() != 1) continue;
    on_boundary[static_cast<std::size_t>(edge.a)] = 1;
    on_boundary[static_cast<std::size_t>(edge.b)] = 1;
  }
  return on_boundary;
}

std::string content_hash(const TriangleMesh& mesh) {
  static_assert(sizeof(int) == 4);
  const std::int64_t counts[2] = {mesh.vertices.cols(), mesh.faces.cols()};
  Sha256 hash;
  hash.update(counts, sizeof counts);
  hash.update(mesh.vertices.data(), static_cast<std::size_t>(mesh.vertices.size()) * sizeof(double));
  hash.update(mesh.faces.data(), static_cast<std::size_t>(mesh.faces.size()) * sizeof(int));
  return hash.finish();
}

}  // namespace bespoke
