#include "bespoke/pattern/detail/auto_cut.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <queue>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/mesh_edges.h"

namespace bespoke {
namespace {

constexpr int no_edge = -1;
constexpr double unreached = std::numeric_limits<double>::infinity();

/// Shortest ways from a node. A boundary loop is one node, named by its least vertex; every other vertex is
/// one.
struct WayTree {
  std::vector<double> distance;  ///< n, at the nodes
  std::vector<int> edge;         ///< n: the one towards the start, or `no_edge`
};

class DiskCut {
 public:
  explicit DiskCut(const TriangleMesh& mesh)
      : mesh_(mesh), edges_(mesh_edges(mesh)), at_vertex_(n()), node_of_(n()), vertices_of_(n()) {
    DisjointSets loops(static_cast<int>(n()));
    for (std::size_t e = 0; e < edges_.edges.size(); ++e) {
      const MeshEdge& of = edges_.edges[e];
      at_vertex_[static_cast<std::size_t>(of.a)].push_back(static_cast<int>(e));
      at_vertex_[static_cast<std::size_t>(of.b)].push_back(static_cast<int>(e));
      if (of.on_boundary()) loops.join(of.a, of.b);
    }
    for (int v = 0; v < static_cast<int>(n()); ++v) {
      node_of_[static_cast<std::size_t>(v)] = loops.least(v);
      vertices_of_[static_cast<std::size_t>(loops.least(v))].push_back(v);
    }
  }

  std::vector<std::array<int, 2>> run() const {
    const auto boundary = std::find_if(edges_.edges.begin(), edges_.edges.end(),
                                       [](const MeshEdge& edge) { return edge.on_boundary(); });
    const WayTree tree = ways(boundary == edges_.edges.end() ? 0 : node(boundary->a));
    std::vector<char> is_cut = pruned(uncrossed(tree));
    std::vector<std::array<int, 2>> cut = inner(is_cut);
    if (cut.empty() && boundary == edges_.edges.end()) cut = longest_way();
    return cut;
  }

 private:
  std::size_t n() const { return static_cast<std::size_t>(mesh_.vertices.cols()); }
  const MeshEdge& edge(int e) const { return edges_.edges[static_cast<std::size_t>(e)]; }
  int across(int e, int vertex) const { return edge(e).a == vertex ? edge(e).b : edge(e).a; }

  int node(int vertex) const { return node_of_[static_cast<std::size_t>(vertex)]; }

  double length(int e) const {
    return (mesh_.vertices.col(edge(e).a) - mesh_.vertices.col(edge(e).b)).norm();
  }

  WayTree ways(int start) const {
    WayTree tree{std::vector<double>(n(), unreached), std::vector<int>(n(), no_edge)};
    using Near = std::pair<double, int>;
    std::priority_queue<Near, std::vector<Near>, std::greater<>> queue;
    tree.distance[static_cast<std::size_t>(start)] = 0;
    queue.emplace(0.0, start);
    while (!queue.empty()) {
      const auto [distance, from] = queue.top();
      queue.pop();
      if (distance > tree.distance[static_cast<std::size_t>(from)]) continue;
      for (const int vertex : vertices_of_[static_cast<std::size_t>(from)])
        for (const int e : at_vertex_[static_cast<std::size_t>(vertex)]) {
          if (edge(e).on_boundary()) continue;
          const auto other = static_cast<std::size_t>(node(across(e, vertex)));
          if (!(distance + length(e) < tree.distance[other])) continue;
          tree.distance[other] = distance + length(e);
          tree.edge[other] = e;
          queue.emplace(tree.distance[other], static_cast<int>(other));
        }
    }
    return tree;
  }

  /// One flag an edge: not crossed by the tree of faces that prefers the edges of long loops.
  std::vector<char> uncrossed(const WayTree& tree) const {
    std::vector<char> stays(edges_.edges.size(), 1), is_in_tree(edges_.edges.size(), 0);
    for (const int e : tree.edge)
      if (e != no_edge) is_in_tree[static_cast<std::size_t>(e)] = 1;
    std::vector<std::array<int, 2>> faces(edges_.edges.size(), {no_edge, no_edge});
    for (Eigen::Index f = 0; f < mesh_.faces.cols(); ++f)
      for (int k = 0; k < 3; ++k) {
        auto& of_edge = faces[static_cast<std::size_t>(edges_.of_face(k, f))];
        of_edge[of_edge[0] == no_edge ? 0 : 1] = static_cast<int>(f);
      }
    std::vector<int> order;
    std::vector<double> loop(edges_.edges.size());
    for (std::size_t e = 0; e < edges_.edges.size(); ++e) {
      if (is_in_tree[e] || edges_.edges[e].on_boundary()) continue;
      const auto& ends = edges_.edges[e];
      loop[e] = tree.distance[static_cast<std::size_t>(node(ends.a))] +
                tree.distance[static_cast<std::size_t>(node(ends.b))] + length(static_cast<int>(e));
      order.push_back(static_cast<int>(e));
    }
    std::stable_sort(order.begin(), order.end(), [&](int i, int j) {
      return loop[static_cast<std::size_t>(i)] > loop[static_cast<std::size_t>(j)];
    });
    DisjointSets joined(static_cast<int>(mesh_.faces.cols()));
    for (const int e : order) {
      const auto& [one, other] = faces[static_cast<std::size_t>(e)];
      if (joined.join(one, other)) stays[static_cast<std::size_t>(e)] = 0;
    }
    return stays;
  }

  /// Without the branches that end inside the surface.
  std::vector<char> pruned(std::vector<char> stays) const {
    std::vector<int> degree(n(), 0), ends;
    for (std::size_t e = 0; e < stays.size(); ++e)
      if (stays[e]) {
        ++degree[static_cast<std::size_t>(edges_.edges[e].a)];
        ++degree[static_cast<std::size_t>(edges_.edges[e].b)];
      }
    for (std::size_t v = 0; v < degree.size(); ++v)
      if (degree[v] == 1) ends.push_back(static_cast<int>(v));
    while (!ends.empty()) {
      const int vertex = ends.back();
      ends.pop_back();
      for (const int e : at_vertex_[static_cast<std::size_t>(vertex)]) {
        if (!stays[static_cast<std::size_t>(e)]) continue;
        stays[static_cast<std::size_t>(e)] = 0;
        const int other = across(e, vertex);
        if (--degree[static_cast<std::size_t>(other)] == 1) ends.push_back(other);
      }
      degree[static_cast<std::size_t>(vertex)] = 0;
    }
    return stays;
  }

  std::vector<std::array<int, 2>> inner(const std::vector<char>& stays) const {
    std::vector<std::array<int, 2>> result;
    for (std::size_t e = 0; e < stays.size(); ++e)
      if (stays[e] && !edges_.edges[e].on_boundary())
        result.push_back({edges_.edges[e].a, edges_.edges[e].b});
    return result;
  }

  /// Between a vertex far from the first and one far from that.
  std::vector<std::array<int, 2>> longest_way() const {
    const auto farthest = [&](int from) {
      const WayTree tree = ways(from);
      return static_cast<int>(std::max_element(tree.distance.begin(), tree.distance.end()) -
                              tree.distance.begin());
    };
    const int begin = farthest(0);
    const WayTree tree = ways(begin);
    std::vector<std::array<int, 2>> way;
    int at = farthest(begin);
    for (int e = tree.edge[static_cast<std::size_t>(at)]; e != no_edge;
         e = tree.edge[static_cast<std::size_t>(at)]) {
      way.push_back({edge(e).a, edge(e).b});
      at = across(e, at);
    }
    return way;
  }

  const TriangleMesh& mesh_;
  MeshEdges edges_;
  std::vector<std::vector<int>> at_vertex_;
  std::vector<int> node_of_;
  std::vector<std::vector<int>> vertices_of_;
};

}  // namespace

std::vector<std::array<int, 2>> edges_to_a_disk(const TriangleMesh& mesh) { return DiskCut(mesh).run(); }

}  // namespace bespoke
