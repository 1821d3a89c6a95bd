#include "bespoke/asset/source_surface.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "bespoke/asset/grids/preview.h"
#include "bespoke/error.h"
#include "bespoke/lattice/lattice.h"
#include "bespoke/lattice/leaf_table.h"

namespace bespoke {
namespace {

constexpr int no_vertex = -1;

class SurfaceNet {
 public:
  explicit SurfaceNet(const StoredGrid& grid)
      : grid_(grid), table_(grid.leaves), vertex_of_(grid.values.size(), no_vertex) {}

  TriangleMesh surface() {
    for_each_node([&](const LatticeCoordinates& node, std::size_t slot) { add_vertex(node, slot); });
    for_each_node([&](const LatticeCoordinates& node, std::size_t slot) { add_faces(node, slot); });
    TriangleMesh mesh{Points(3, static_cast<Eigen::Index>(vertices_.size())),
                      Faces(3, static_cast<Eigen::Index>(faces_.size()))};
    for (std::size_t i = 0; i < vertices_.size(); ++i)
      mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices_[i];
    for (std::size_t i = 0; i < faces_.size(); ++i) mesh.faces.col(static_cast<Eigen::Index>(i)) = faces_[i];
    return mesh;
  }

 private:
  template <class Visit>
  void for_each_node(const Visit& visit) const {
    for (std::size_t leaf = 0; leaf < grid_.leaves.size(); ++leaf)
      for (int number = 0; number < leaf_nodes; ++number)
        visit(moved(first_node(grid_.leaves[leaf]), place_of_number(number)),
              leaf * leaf_nodes + static_cast<std::size_t>(number));
  }

  /// Where the value of a node stands; empty outside of the leaves.
  std::optional<std::size_t> slot_of(const LatticeCoordinates& node) const {
    const int leaf = table_.find(leaf_of(node));
    if (leaf == no_leaf) return std::nullopt;
    return static_cast<std::size_t>(leaf) * leaf_nodes +
           static_cast<std::size_t>(number_of_place(place_in_leaf(node)));
  }

  /// The middle of the crossings of a cell's edges, where all its nodes are known.
  void add_vertex(const LatticeCoordinates& node, std::size_t slot) {
    std::array<double, 8> values{};
    for (int corner = 0; corner < 8; ++corner) {
      const auto at = slot_of(moved(node, corner_step(corner)));
      if (!at) return;
      values[static_cast<std::size_t>(corner)] = grid_.values[*at];
    }
    Vector3 sum = Vector3::Zero();
    int crossings = 0;
    for (int from = 0; from < 8; ++from)
      for (const int step : {1, 2, 4}) {
        if ((from & step) != 0) continue;
        const double a = values[static_cast<std::size_t>(from)],
                     b = values[static_cast<std::size_t>(from | step)];
        if ((a < 0) == (b < 0)) continue;
        sum += as_vector(corner_step(from)) +
               a / (a - b) * (as_vector(corner_step(from | step)) - as_vector(corner_step(from)));
        ++crossings;
      }
    if (crossings == 0) return;
    vertex_of_[slot] = static_cast<int>(vertices_.size());
    vertices_.push_back(Lattice{grid_.origin, grid_.voxel_size}.at(as_vector(node) + sum / crossings));
  }

  /// For every edge from the node that crosses the surface, the four cells around it as two faces, outward.
  void add_faces(const LatticeCoordinates& node, std::size_t slot) {
    for (int axis = 0; axis < 3; ++axis) {
      LatticeCoordinates along{}, left{}, below{};
      along[static_cast<std::size_t>(axis)] = 1;
      left[static_cast<std::size_t>((axis + 1) % 3)] = -1;
      below[static_cast<std::size_t>((axis + 2) % 3)] = -1;
      const auto next = slot_of(moved(node, along));
      if (!next || (grid_.values[slot] < 0) == (grid_.values[*next] < 0)) continue;
      std::array<int, 4> ring{};
      std::size_t known = 0;
      for (const LatticeCoordinates& cell :
           {node, moved(node, left), moved(moved(node, left), below), moved(node, below)})
        if (const auto at = slot_of(cell); at && vertex_of_[*at] != no_vertex)
          ring[known++] = vertex_of_[*at];
      if (known < ring.size()) continue;
      if (!(grid_.values[slot] < 0)) std::reverse(ring.begin(), ring.end());
      faces_.emplace_back(ring[0], ring[1], ring[2]);
      faces_.emplace_back(ring[0], ring[2], ring[3]);
    }
  }

  const StoredGrid& grid_;
  LeafTable table_;
  std::vector<int> vertex_of_;  // of the cell that starts at a node
  std::vector<Vector3> vertices_;
  std::vector<Eigen::Vector3i> faces_;
};

}  // namespace

TriangleMesh source_surface(const Asset& asset) {
  if (!asset.preview) throw InvalidInput("an asset without previews has no picture of its source");
  for (const StoredGrid& grid : asset.preview->grids())
    if (grid.name == source_distance_name) return SurfaceNet(grid).surface();
  throw InvalidInput("the asset holds no distance field of its source");
}

}  // namespace bespoke
