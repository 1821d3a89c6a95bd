#include "bespoke/cloud/detail/surface_net.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "bespoke/lattice/leaf_table.h"
#include "bespoke/parallel.h"

namespace bespoke {
namespace {

constexpr int no_vertex = -1;
constexpr std::size_t leaf_grain = 16;
constexpr std::size_t vertex_grain = 256;

using Block = std::array<float, block_nodes>;

/// A cell that the surface goes through.
struct Crossing {
  int number;     ///< of the cell in its leaf
  Vector3 start;  ///< of its vertex
};

class SurfaceNet {
 public:
  explicit SurfaceNet(const SparseField& field)
      : field_(field), table_(field.leaves), crossings_(field.leaves.size()) {
    for_each_leaf([&](std::size_t leaf) { find_crossings(leaf); });
  }

  /// Places the vertices; those without a place get no number.
  void place_vertices(const PlaceVertex& place) {
    std::vector<Vector3> starts;
    for (const auto& of_leaf : crossings_)
      for (const Crossing& crossing : of_leaf) starts.push_back(crossing.start);
    std::vector<std::optional<Vector3>> placed(starts.size());
    parallel_for(starts.size(), vertex_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) placed[i] = place(starts[i]);
    });
    vertex_of_cell_.assign(field_.values.size(), no_vertex);
    std::size_t next = 0;
    for (std::size_t leaf = 0; leaf < crossings_.size(); ++leaf)
      for (const Crossing& crossing : crossings_[leaf])
        if (const std::optional<Vector3>& vertex = placed[next++]) {
          vertex_of_cell_[leaf * leaf_nodes + static_cast<std::size_t>(crossing.number)] =
              static_cast<int>(vertices_.size());
          vertices_.push_back(*vertex);
        }
  }

  /// With the vertices that faces use.
  TriangleMesh mesh() const {
    std::vector<std::vector<int>> corners(field_.leaves.size());
    for_each_leaf([&](std::size_t leaf) { corners[leaf] = faces_of(leaf); });
    std::vector<int> number(vertices_.size(), no_vertex), used, all;
    for (const std::vector<int>& of_leaf : corners)
      for (const int vertex : of_leaf) {
        int& mine = number[static_cast<std::size_t>(vertex)];
        if (mine == no_vertex) {
          mine = static_cast<int>(used.size());
          used.push_back(vertex);
        }
        all.push_back(mine);
      }
    TriangleMesh mesh;
    mesh.vertices.resize(3, static_cast<Eigen::Index>(used.size()));
    for (std::size_t i = 0; i < used.size(); ++i)
      mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices_[static_cast<std::size_t>(used[i])];
    mesh.faces = Eigen::Map<const Faces>(all.data(), 3, static_cast<Eigen::Index>(all.size() / 3));
    return mesh;
  }

 private:
  template <class Visit>
  void for_each_leaf(const Visit& visit) const {
    parallel_for(field_.leaves.size(), leaf_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t leaf = begin; leaf < end; ++leaf) visit(leaf);
    });
  }

  /// The nodes of the leaf's cells, which lie in it and its upper neighbours.
  Block block_of(std::size_t leaf) const {
    std::array<int, 8> leaves;
    for (int i = 0; i < 8; ++i)
      leaves[static_cast<std::size_t>(i)] = table_.find(moved(field_.leaves[leaf], corner_step(i)));
    Block block;
    for (int number = 0; number < block_nodes; ++number) {
      const LatticeCoordinates place = place_in_block(number);
      const int holder = leaves[static_cast<std::size_t>(leaf_of_block(place))];
      block[static_cast<std::size_t>(number)] =
          holder == no_leaf ? SparseField::unknown
                            : field_.values[static_cast<std::size_t>(holder) * leaf_nodes +
                                            static_cast<std::size_t>(number_of_place(place_in_leaf(place)))];
    }
    return block;
  }

  void find_crossings(std::size_t leaf) {
    const Block block = block_of(leaf);
    for (int number = 0; number < leaf_nodes; ++number) {
      const LatticeCoordinates cell = place_of_number(number);
      std::array<float, 8> values;
      int known = 0, negative = 0;
      for (int corner = 0; corner < 8; ++corner) {
        const float value =
            block[static_cast<std::size_t>(number_in_block(moved(cell, corner_step(corner))))];
        values[static_cast<std::size_t>(corner)] = value;
        known += !std::isnan(value);
        negative += value < 0;
      }
      if (known < 8 || negative == 0 || negative == 8) continue;
      const LatticeCoordinates node = moved(first_node(field_.leaves[leaf]), cell);
      crossings_[leaf].push_back({number, field_.place(node) + field_.cell * mean_crossing(values)});
    }
  }

  /// In the cell, edges of length 1.
  static Vector3 mean_crossing(const std::array<float, 8>& values) {
    Vector3 sum = Vector3::Zero();
    int crossings = 0;
    for (int a = 0; a < 8; ++a)
      for (const int bit : {4, 2, 1}) {
        const double from = values[static_cast<std::size_t>(a)];
        const double to = values[static_cast<std::size_t>(a | bit)];
        if ((a & bit) != 0 || (from < 0) == (to < 0)) continue;
        const auto vector = [](const LatticeCoordinates& step) { return Vector3(step[0], step[1], step[2]); };
        sum += vector(corner_step(a)) + from / (from - to) * vector(corner_step(bit));
        ++crossings;
      }
    return sum / crossings;
  }

  int vertex_of(const LatticeCoordinates& cell) const {
    const int leaf = table_.find(leaf_of(cell));
    if (leaf == no_leaf) return no_vertex;
    return vertex_of_cell_[static_cast<std::size_t>(leaf) * leaf_nodes +
                           static_cast<std::size_t>(number_of_place(place_in_leaf(cell)))];
  }

  /// Corners of the triangles around the edges that go up from the leaf's nodes.
  std::vector<int> faces_of(std::size_t leaf) const {
    std::vector<int> corners;
    const Block block = block_of(leaf);
    for (int number = 0; number < leaf_nodes; ++number) {
      const LatticeCoordinates place = place_of_number(number);
      const float from = block[static_cast<std::size_t>(number_in_block(place))];
      for (std::size_t axis = 0; axis < 3; ++axis) {
        LatticeCoordinates above = place;
        ++above[axis];
        const float to = block[static_cast<std::size_t>(number_in_block(above))];
        if (std::isnan(from) || std::isnan(to) || (from < 0) == (to < 0)) continue;
        add_quadrilateral(moved(first_node(field_.leaves[leaf]), place), axis, from < 0, corners);
      }
    }
    return corners;
  }

  /// Of the cells around the edge that goes up from a node, counter-clockwise seen from where it is positive.
  void add_quadrilateral(const LatticeCoordinates& node, std::size_t axis, bool outwards,
                         std::vector<int>& corners) const {
    const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
    std::array<LatticeCoordinates, 4> cells{node, node, node, node};
    for (const std::size_t i : {0u, 3u}) --cells[i][b];
    for (const std::size_t i : {0u, 1u}) --cells[i][c];
    std::array<int, 4> quad;
    for (std::size_t i = 0; i < 4; ++i) quad[i] = vertex_of(cells[outwards ? i : 3 - i]);
    for (const int vertex : quad)
      if (vertex == no_vertex) return;
    const auto squared_length = [&](std::size_t from, std::size_t to) {
      return (vertices_[static_cast<std::size_t>(quad[from])] - vertices_[static_cast<std::size_t>(quad[to])])
          .squaredNorm();
    };
    if (squared_length(0, 2) <= squared_length(1, 3))
      corners.insert(corners.end(), {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]});
    else
      corners.insert(corners.end(), {quad[0], quad[1], quad[3], quad[1], quad[2], quad[3]});
  }

  const SparseField& field_;
  LeafTable table_;
  std::vector<std::vector<Crossing>> crossings_;  // of each leaf
  std::vector<int> vertex_of_cell_;               // 512 a leaf
  std::vector<Vector3> vertices_;
};

}  // namespace

// Surface nets (Gibson 1998).
TriangleMesh surface_net(const SparseField& field, const PlaceVertex& place) {
  SurfaceNet net(field);
  net.place_vertices(place);
  return net.mesh();
}

}  // namespace bespoke
