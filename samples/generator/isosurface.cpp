#include "isosurface.h"

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

namespace bespoke {
namespace {

using Index3 = Eigen::Vector3i;

// Freudenthal's six tetrahedra of a cube as corner numbers (bit i: axis i); each positively oriented.
constexpr std::array<std::array<int, 4>, 6> cube_tetrahedra = {
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

// For each set of inside corners (bit i: corner i), an even order that puts them first.
constexpr std::array<std::array<int, 4>, 16> inside_first = {{{0, 1, 2, 3},
                                                              {0, 1, 2, 3},
                                                              {1, 0, 3, 2},
                                                              {0, 1, 2, 3},
                                                              {2, 3, 0, 1},
                                                              {0, 2, 3, 1},
                                                              {1, 2, 0, 3},
                                                              {0, 1, 2, 3},
                                                              {3, 2, 1, 0},
                                                              {0, 3, 1, 2},
                                                              {1, 3, 2, 0},
                                                              {0, 3, 1, 2},
                                                              {2, 3, 0, 1},
                                                              {0, 2, 3, 1},
                                                              {1, 3, 2, 0},
                                                              {0, 1, 2, 3}}};

class Marcher {
 public:
  Marcher(const Field& field, const Lattice& lattice) : field_(field), lattice_(lattice) {
    const Vector3 half = 0.5 * lattice.box.diagonal();
    // The rotated lattice must still cover the box.
    const Vector3 reach = lattice.rotation.transpose().cwiseAbs() * half;
    for (int axis = 0; axis < 3; ++axis)
      count_[axis] = static_cast<int>(std::ceil(2 * reach[axis] / lattice.spacing)) + 3;
    values_.assign(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2], unknown);
  }

  TriangleMesh march(const Vector3& inside) {
    for (const int cell : crossed_cells(inside)) {
      for (const auto& tetrahedron : cube_tetrahedra) add_tetrahedron(cell, tetrahedron);
    }
    TriangleMesh mesh;
    mesh.vertices =
        Eigen::Map<const Points>(vertices_[0].data(), 3, static_cast<Eigen::Index>(vertices_.size()));
    mesh.faces = Eigen::Map<const Faces>(faces_[0].data(), 3, static_cast<Eigen::Index>(faces_.size()));
    return mesh;
  }

 private:
  static constexpr double unknown = std::numeric_limits<double>::infinity();

  int node(const Index3& index) const { return index[0] + count_[0] * (index[1] + count_[1] * index[2]); }
  Index3 index_of(int node) const {
    return {node % count_[0], node / count_[0] % count_[1], node / (count_[0] * count_[1])};
  }
  int corner(int cell, int bits) const {
    return cell + (bits & 1) + count_[0] * ((bits >> 1 & 1) + count_[1] * (bits >> 2 & 1));
  }
  Vector3 position(int node) const {
    const Vector3 middle = 0.5 * (count_ - Index3::Ones()).cast<double>();
    return lattice_.box.center() +
           lattice_.rotation * (lattice_.spacing * (index_of(node).cast<double>() - middle));
  }
  double value(int node) {
    if (values_[node] == unknown) values_[node] = field_(position(node));
    return values_[node];
  }

  bool crossed(int cell) {
    int inside = 0;
    for (int bits = 0; bits < 8; ++bits) inside += value(corner(cell, bits)) < 0;
    return inside > 0 && inside < 8;
  }

  int first_crossed(const Vector3& inside) {
    const Vector3 middle = 0.5 * (count_ - Index3::Ones()).cast<double>();
    const Vector3 start =
        lattice_.rotation.transpose() * (inside - lattice_.box.center()) / lattice_.spacing + middle;
    Index3 index = start.array().floor().cast<int>();
    for (; index[0] >= 0 && index[0] + 1 < count_[0]; ++index[0]) {
      if (crossed(node(index))) return node(index);
    }
    throw InvalidInput("no surface was found along +x from the inside point of a sample");
  }

  std::vector<int> crossed_cells(const Vector3& inside) {
    std::vector<int> found = {first_crossed(inside)};
    std::vector<char> seen(values_.size(), 0);
    seen[found[0]] = 1;
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Index3 index = index_of(found[i]);
      for (int direction = 0; direction < 6; ++direction) {
        Index3 next = index;
        next[direction / 2] += direction % 2 ? 1 : -1;
        if (next.minCoeff() < 0 || (next.array() + 1 >= count_.array()).any()) {
          throw InvalidInput("a sample's surface leaves its lattice");
        }
        const int cell = node(next);
        if (seen[cell]) continue;
        seen[cell] = 1;
        if (crossed(cell)) found.push_back(cell);
      }
    }
    std::sort(found.begin(), found.end());
    return found;
  }

  int vertex(int a, int b) {
    if (a > b) std::swap(a, b);
    const auto [place, is_new] = vertex_of_edge_.try_emplace(
        static_cast<long>(a) * static_cast<long>(values_.size()) + b, vertices_.size());
    if (is_new) {
      // Away from the nodes no triangle collapses to nothing.
      const double s = std::clamp(value(a) / (value(a) - value(b)), 0.05, 0.95);
      vertices_.push_back((1 - s) * position(a) + s * position(b));
    }
    return place->second;
  }

  void add_tetrahedron(int cell, const std::array<int, 4>& corners) {
    int mask = 0;
    std::array<int, 4> nodes;
    for (int i = 0; i < 4; ++i) {
      nodes[i] = corner(cell, corners[i]);
      if (value(nodes[i]) < 0) mask |= 1 << i;
    }
    if (mask == 0 || mask == 15) return;
    std::array<int, 4> n;
    for (int i = 0; i < 4; ++i) n[i] = nodes[inside_first[mask][i]];
    switch (__builtin_popcount(mask)) {
      case 1:
        faces_.emplace_back(vertex(n[0], n[1]), vertex(n[0], n[2]), vertex(n[0], n[3]));
        break;
      case 2:
        faces_.emplace_back(vertex(n[0], n[2]), vertex(n[0], n[3]), vertex(n[1], n[3]));
        faces_.emplace_back(vertex(n[0], n[2]), vertex(n[1], n[3]), vertex(n[1], n[2]));
        break;
      default:
        faces_.emplace_back(vertex(n[3], n[0]), vertex(n[3], n[1]), vertex(n[3], n[2]));
    }
  }

  const Field& field_;
  const Lattice& lattice_;
  Index3 count_;
  std::vector<double> values_;  // per node
  std::unordered_map<long, int> vertex_of_edge_;
  std::vector<Vector3> vertices_;
  std::vector<Index3> faces_;
};

}  // namespace

TriangleMesh isosurface(const Field& field, const Vector3& inside, const Lattice& lattice) {
  return Marcher(field, lattice).march(inside);
}

TriangleMesh clip(const TriangleMesh& mesh, const Field& keep) {
  std::vector<double> value(mesh.vertices.cols());
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) value[i] = keep(mesh.vertices.col(i));

  std::vector<Vector3> vertices;
  std::vector<Index3> faces;
  const MeshEdges table = mesh_edges(mesh);
  std::vector<std::optional<int>> of_vertex(value.size()), of_edge(table.edges.size());
  const auto kept_vertex = [&](int vertex) {
    std::optional<int>& made = of_vertex[vertex];
    if (!made) {
      made = static_cast<int>(vertices.size());
      vertices.push_back(mesh.vertices.col(vertex));
    }
    return *made;
  };
  const auto cut_vertex = [&](int edge) {
    std::optional<int>& made = of_edge[edge];
    if (!made) {
      const int a = table.edges[edge].a, b = table.edges[edge].b;
      const double s = std::clamp(value[a] / (value[a] - value[b]), 0.02, 0.98);
      made = static_cast<int>(vertices.size());
      vertices.push_back((1 - s) * mesh.vertices.col(a) + s * mesh.vertices.col(b));
    }
    return *made;
  };
  for (Eigen::Index column = 0; column < mesh.faces.cols(); ++column) {
    if (table.of_face(0, column) == MeshEdges::none) continue;  // no area
    const Index3 face = mesh.faces.col(column);
    std::vector<int> polygon;
    for (int i = 0; i < 3; ++i) {
      const int from = face[i];
      const int to = face[(i + 1) % 3];
      if (value[from] < 0) polygon.push_back(kept_vertex(from));
      if ((value[from] < 0) != (value[to] < 0)) polygon.push_back(cut_vertex(table.of_face(i, column)));
    }
    for (std::size_t i = 2; i < polygon.size(); ++i)
      faces.emplace_back(polygon[0], polygon[i - 1], polygon[i]);
  }
  if (faces.empty()) throw InvalidInput("nothing of a sample's surface is left after cutting");
  TriangleMesh kept;
  kept.vertices = Eigen::Map<const Points>(vertices[0].data(), 3, static_cast<Eigen::Index>(vertices.size()));
  kept.faces = Eigen::Map<const Faces>(faces[0].data(), 3, static_cast<Eigen::Index>(faces.size()));
  return kept;
}

}  // namespace bespoke
