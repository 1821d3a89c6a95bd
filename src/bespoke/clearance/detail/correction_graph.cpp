#include "bespoke/clearance/detail/correction_graph.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "bespoke/mesh/closest_point.h"
#include "bespoke/mesh/equal_positions.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/topology/mesh_components.h"

namespace bespoke {
namespace {

// How near shells are that stay together: an edge's length, but of the product's diagonal no less than the
// thickness of cloth with seams (3 mm on a person) and no more than its looseness (1 cm to 2 cm).
constexpr double min_nearness = 0.003, max_nearness = 0.01;

// A tie holds as two edges do: the six edges of a vertex outweigh it, its own two sheets do not part.
constexpr double tie_weight = 2;

// Opposite sheets face away from each other within 60°.
constexpr double opposite_cosine = 0.5;

using Triplets = std::vector<Eigen::Triplet<double>>;

class GraphBuilder {
 public:
  GraphBuilder(const TriangleMesh& product, const Eigen::Matrix2Xi& lines,
               const std::vector<int>& part_of_vertex)
      : lines_(lines), first_(first_at_equal_position(product.vertices)), joined_(product) {
    for (int& vertex : joined_.faces.reshaped()) vertex = first_[static_cast<std::size_t>(vertex)];
    edges_ = mesh_edges(joined_);
    place_nodes(part_of_vertex);
    nearness_ = nearness();
  }

  CorrectionGraph build() {
    if (joined_.faces.cols() > 0) {
      join_shells();
      tie_sheets();
    }
    return graph();
  }

 private:
  int vertices() const { return static_cast<int>(joined_.vertices.cols()); }

  /// A node each place or part. Parts that have a place in common become one.
  void place_nodes(const std::vector<int>& part_of_vertex) {
    node_.assign(first_.size(), -1);
    std::map<int, int> of_part;
    const auto part = [&](std::size_t v) { return part_of_vertex.empty() ? no_part : part_of_vertex[v]; };
    for (std::size_t v = 0; v < first_.size(); ++v)
      if (part(v) != no_part) {
        int& node = node_[static_cast<std::size_t>(first_[v])];
        if (node < 0) node = of_part.try_emplace(part(v), nodes_).first->second;
        nodes_ = std::max(nodes_, node + 1);
      }
    is_part_node_.assign(static_cast<std::size_t>(nodes_), 1);
    for (std::size_t v = 0; v < first_.size(); ++v) {
      int& node = node_[static_cast<std::size_t>(first_[v])];
      if (node < 0) node = nodes_++;
      node_[v] = node;
    }
    is_part_node_.resize(static_cast<std::size_t>(nodes_), 0);
    is_tied_.assign(static_cast<std::size_t>(nodes_), 0);
    host_.assign(static_cast<std::size_t>(nodes_), {});
  }

  double nearness() const {
    double sum = 0;
    for (const MeshEdge& edge : edges_.edges)
      sum += (joined_.vertices.col(edge.a) - joined_.vertices.col(edge.b)).norm();
    const double size = diagonal(joined_.vertices);
    const double mean = edges_.edges.empty() ? 0 : sum / static_cast<double>(edges_.edges.size());
    return std::clamp(mean, min_nearness * size, max_nearness * size);
  }

  int node(int vertex) const { return node_[static_cast<std::size_t>(vertex)]; }

  void tie(int from, const SurfacePoint& at, const Faces& faces) {
    for (int k = 0; k < 3; ++k) {
      const int to = node(faces(k, at.face));
      if (to == from || !(at.barycentric(k) > 0)) continue;
      weights_.emplace_back(from, to, tie_weight * at.barycentric(k));
      weights_.emplace_back(to, from, tie_weight * at.barycentric(k));
      is_tied_[static_cast<std::size_t>(from)] = is_tied_[static_cast<std::size_t>(to)] = 1;
    }
  }

  /// Shells from the largest on: one that lies on the larger ones everywhere goes with them, others are tied
  /// where they are near.
  void join_shells() {
    const MeshComponents shells = mesh_components(joined_);
    if (shells.count() < 2) return;
    std::vector<double> area(static_cast<std::size_t>(shells.count()), 0);
    std::vector<std::vector<int>> faces(area.size()), members(area.size());
    for (int face = 0; face < static_cast<int>(joined_.faces.cols()); ++face) {
      const auto shell = static_cast<std::size_t>(shells.of_face[static_cast<std::size_t>(face)]);
      faces[shell].push_back(face);
      const auto corner = [&](int k) { return joined_.vertices.col(joined_.faces(k, face)); };
      area[shell] += (corner(1) - corner(0)).head<3>().cross((corner(2) - corner(0)).head<3>()).norm() / 2;
    }
    for (int v = 0; v < vertices(); ++v)
      if (const int shell = shells.of_vertex[static_cast<std::size_t>(v)]; shell != MeshComponents::none)
        members[static_cast<std::size_t>(shell)].push_back(v);
    std::vector<std::size_t> order(area.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return area[a] > area[b]; });
    std::vector<int> host_faces = faces[order.front()];
    for (std::size_t i = 1; i < order.size(); ++i)
      if (!goes_with(members[order[i]], host_faces))
        host_faces.insert(host_faces.end(), faces[order[i]].begin(), faces[order[i]].end());
  }

  /// Whether the shell lies on the hosts everywhere and so has no nodes of its own; else it is tied to them.
  bool goes_with(const std::vector<int>& shell, const std::vector<int>& host_faces) {
    // The tree grows only with shells that are hosts.
    if (host_faces.size() != hosts_.size()) {
      hosts_ = host_faces;
      host_mesh_ = {joined_.vertices, Faces(3, static_cast<Eigen::Index>(hosts_.size()))};
      for (std::size_t i = 0; i < hosts_.size(); ++i)
        host_mesh_.faces.col(static_cast<Eigen::Index>(i)) = joined_.faces.col(hosts_[i]);
      tree_.emplace(host_mesh_);
    }
    std::vector<std::optional<SurfacePoint>> near;
    bool everywhere = true;
    for (const int vertex : shell) {
      near.push_back(tree_->closest(joined_.vertices.col(vertex), {.max_distance = nearness_}));
      everywhere = everywhere && near.back() && !is_part_node_[static_cast<std::size_t>(node(vertex))];
    }
    for (std::size_t i = 0; i < shell.size(); ++i) {
      if (!near[i]) continue;
      const int own = node(shell[i]);
      if (!everywhere) {
        tie(own, *near[i], host_mesh_.faces);
        continue;
      }
      for (int k = 0; k < 3; ++k)
        if (near[i]->barycentric(k) > 0)
          host_[static_cast<std::size_t>(own)].emplace_back(node(host_mesh_.faces(k, near[i]->face)),
                                                            near[i]->barycentric(k));
    }
    return everywhere;
  }

  /// The two sides of cloth that has a thickness.
  void tie_sheets() {
    const Points normals = vertex_normals(joined_);
    const ClosestPointTree tree(joined_);
    const VertexAdjacency around = vertex_adjacency(joined_);
    const auto is_next_to = [&](int vertex, int face) {
      const auto v = static_cast<std::size_t>(vertex);
      for (const int corner : joined_.faces.col(face))
        if (corner == vertex || std::binary_search(around.neighbours.begin() + around.start[v],
                                                   around.neighbours.begin() + around.start[v + 1], corner))
          return true;
      return false;
    };
    for (int v = 0; v < vertices(); ++v) {
      if (first_[static_cast<std::size_t>(v)] != v || normals.col(v).isZero(0)) continue;
      if (!host_[static_cast<std::size_t>(node(v))].empty()) continue;
      const auto opposite = tree.closest(
          joined_.vertices.col(v),
          {.max_distance = nearness_, .normal = Vector3(-normals.col(v)), .min_cosine = opposite_cosine});
      if (opposite && !is_next_to(v, opposite->face)) tie(node(v), *opposite, joined_.faces);
    }
  }

  void add_edge(int a, int b) {
    if (a == b) return;
    weights_.emplace_back(a, b, 1);
    weights_.emplace_back(b, a, 1);
  }

  CorrectionGraph graph() {
    for (const MeshEdge& edge : edges_.edges) add_edge(node(edge.a), node(edge.b));
    for (Eigen::Index i = 0; i < lines_.cols(); ++i) add_edge(node(lines_(0, i)), node(lines_(1, i)));
    // Nodes of shells that go with others are left out.
    std::vector<int> number(static_cast<std::size_t>(nodes_), -1);
    int count = 0;
    for (std::size_t i = 0; i < number.size(); ++i)
      if (host_[i].empty()) number[i] = count++;
    CorrectionGraph graph;
    Triplets rows, weights;
    for (int v = 0; v < vertices(); ++v) {
      const auto own = static_cast<std::size_t>(node(v));
      if (number[own] >= 0) rows.emplace_back(v, number[own], 1);
      for (const auto& [host, weight] : host_[own])
        rows.emplace_back(v, number[static_cast<std::size_t>(host)], weight);
    }
    for (const auto& entry : weights_) {
      const int a = number[static_cast<std::size_t>(entry.row())];
      const int b = number[static_cast<std::size_t>(entry.col())];
      if (a >= 0 && b >= 0) weights.emplace_back(a, b, entry.value());
    }
    graph.vertex_from_node.resize(vertices(), count);
    graph.vertex_from_node.setFromTriplets(rows.begin(), rows.end());
    graph.weights.resize(count, count);
    graph.weights.setFromTriplets(weights.begin(), weights.end());
    graph.is_tied.assign(static_cast<std::size_t>(count), 0);
    graph.is_part = graph.is_tied;
    for (std::size_t i = 0; i < number.size(); ++i) {
      if (number[i] < 0) continue;
      graph.is_tied[static_cast<std::size_t>(number[i])] = is_tied_[i];
      graph.is_part[static_cast<std::size_t>(number[i])] = is_part_node_[i];
    }
    return graph;
  }

  const Eigen::Matrix2Xi& lines_;
  std::vector<int> first_;
  TriangleMesh joined_;  // faces refer to the first vertex at a position
  MeshEdges edges_;
  int nodes_ = 0;
  std::vector<int> node_;  // of every vertex
  std::vector<char> is_part_node_, is_tied_;
  std::vector<std::vector<std::pair<int, double>>> host_;  // of nodes that go with others
  double nearness_ = 0;
  Triplets weights_;
  std::vector<int> hosts_;
  TriangleMesh host_mesh_;
  std::optional<ClosestPointTree> tree_;
};

}  // namespace

CorrectionGraph correction_graph(const TriangleMesh& product, const Eigen::Matrix2Xi& lines,
                                 const std::vector<int>& part_of_vertex) {
  return GraphBuilder(product, lines, part_of_vertex).build();
}

}  // namespace bespoke
