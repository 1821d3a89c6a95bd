#include "bespoke/mesh/cavities.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/visibility.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

/// Directions in which a vertex looks, evenly spread over the half-space of its normal.
constexpr int ray_count = 32;
/// Of them, that an enclosed vertex may have free: an eye socket is exposed between its lids.
constexpr int max_free = 4;
/// Vertices queried at first, evenly chosen; from those enclosed on, their neighbours are.
constexpr std::size_t seeds = 4000;

/// Unit vectors about e_z, the first along it: a spiral of equal areas.
std::array<Vector3, ray_count> half_space() {
  const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
  std::array<Vector3, ray_count> directions;
  for (int k = 0; k < ray_count; ++k) {
    const double height = 1 - double(k) / ray_count, radius = std::sqrt(1 - height * height);
    directions[static_cast<std::size_t>(k)] = {radius * std::cos(k * golden_angle),
                                               radius * std::sin(k * golden_angle), height};
  }
  return directions;
}

bool is_enclosed(const VisibilityQuery& visibility, const Vector3& x, const Vector3& normal,
                 const std::array<Vector3, ray_count>& directions) {
  const Matrix3 turn = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), normal).toRotationMatrix();
  int free = 0;
  for (const Vector3& direction : directions) {
    if (!visibility.is_blocked(x, (turn * direction).normalized())) ++free;
    if (free > max_free) return false;
  }
  return true;
}

/// Neighbours of those vertices that are enclosed, each once, which have not been queried.
std::vector<int> unasked_neighbours(const VertexAdjacency& adjacency, const std::vector<int>& vertices,
                                    const std::vector<char>& enclosed, const std::vector<char>& asked) {
  std::vector<int> found;
  for (const int i : vertices) {
    if (!enclosed[static_cast<std::size_t>(i)]) continue;
    for (int k = adjacency.start[i]; k < adjacency.start[i + 1]; ++k)
      if (const int next = adjacency.neighbours[k]; !asked[static_cast<std::size_t>(next)])
        found.push_back(next);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// A connected part of what is enclosed.
struct EnclosedPart {
  Cavity cavity;
  // Of its faces, including those along its boundary; mesh units squared; length of the boundary, mesh units.
  double area = 0, rim = 0;

  /// A cavity is wider than its opening. One whose boundary is at least as long as that of a disc of its area
  /// is a crease between parts that touch, and opens as these separate.
  bool is_crease() const { return rim * rim >= 4 * std::numbers::pi * area; }
};

}  // namespace

std::vector<char> enclosed_vertices(const TriangleMesh& mesh) {
  const VisibilityQuery visibility(mesh);
  const Points normals = vertex_normals(mesh);
  const std::array<Vector3, ray_count> directions = half_space();
  const auto count = static_cast<std::size_t>(mesh.vertices.cols());
  std::vector<char> enclosed(count, 0), asked(count, 0);
  std::vector<int> waiting;
  const std::size_t stride = (count + seeds - 1) / seeds;
  for (std::size_t i = 0; i < count; i += stride) waiting.push_back(static_cast<int>(i));
  const VertexAdjacency adjacency = vertex_adjacency(mesh);
  while (!waiting.empty()) {
    for (const int i : waiting) asked[static_cast<std::size_t>(i)] = 1;
    constexpr std::size_t grain = 64;
    parallel_for(waiting.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const int i = waiting[k];
        const Vector3 normal = normals.col(i);
        enclosed[static_cast<std::size_t>(i)] =
            !normal.isZero() && is_enclosed(visibility, mesh.vertices.col(i), normal, directions);
      }
    });
    waiting = unasked_neighbours(adjacency, waiting, enclosed, asked);
  }
  const Eigen::VectorXd areas = vertex_areas(mesh);
  double inside = 0;
  for (std::size_t k = 0; k < count; ++k)
    if (enclosed[k]) inside += areas[static_cast<Eigen::Index>(k)];
  if (2 * inside > areas.sum()) std::fill(enclosed.begin(), enclosed.end(), char(0));
  return enclosed;
}

Cavities cavities_of(const TriangleMesh& mesh) {
  Cavities cavities{enclosed_vertices(mesh), {}};
  const auto is_enclosed = [&](int vertex) {
    return cavities.contains[static_cast<std::size_t>(vertex)] != 0;
  };
  if (std::count(cavities.contains.begin(), cavities.contains.end(), 0) == mesh.vertices.cols())
    return cavities;
  const MeshEdges table = mesh_edges(mesh);
  DisjointSets sets(static_cast<int>(mesh.vertices.cols()));
  for (const MeshEdge& edge : table.edges)
    if (is_enclosed(edge.a) && is_enclosed(edge.b)) sets.join(edge.a, edge.b);
  std::map<int, EnclosedPart> parts;  // by the least vertex
  for (int i = 0; i < mesh.vertices.cols(); ++i)
    if (is_enclosed(i)) parts[sets.least(i)].cavity.vertices.push_back(i);
  for (const MeshEdge& edge : table.edges)
    if (is_enclosed(edge.a) || is_enclosed(edge.b))
      parts[sets.least(is_enclosed(edge.a) ? edge.a : edge.b)].cavity.edges.push_back(edge);
  for (const auto& face : mesh.faces.colwise()) {
    const auto inner = std::find_if(face.begin(), face.end(), is_enclosed);
    if (inner == face.end()) continue;
    const Vector3 x = mesh.vertices.col(*inner);
    const int b = face[(inner - face.begin() + 1) % 3], c = face[(inner - face.begin() + 2) % 3];
    EnclosedPart& part = parts[sets.least(*inner)];
    part.area += (mesh.vertices.col(b) - x).cross(mesh.vertices.col(c) - x).norm() / 2;
    if (!is_enclosed(b) && !is_enclosed(c)) part.rim += (mesh.vertices.col(b) - mesh.vertices.col(c)).norm();
  }
  for (auto& [least, part] : parts) {
    if (part.is_crease())
      for (const int vertex : part.cavity.vertices) cavities.contains[static_cast<std::size_t>(vertex)] = 0;
    else
      cavities.parts.push_back(std::move(part.cavity));
  }
  return cavities;
}

}  // namespace bespoke
