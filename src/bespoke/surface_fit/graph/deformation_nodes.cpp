#include "bespoke/surface_fit/graph/deformation_nodes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/mesh/disjoint_sets.h"
#include "bespoke/mesh/surface_paths.h"
#include "bespoke/parallel.h"
#include "bespoke/rbf/point_grid.h"

namespace bespoke {
namespace {

using Near = std::pair<double, int>;  // distance, node: sorts by distance, then by index

/// 1 for the vertices of components large enough to carry nodes of their own.
std::vector<char> carries_nodes(const TriangleMesh& mesh, double spacing, double min_carried_area) {
  DisjointSets components(static_cast<int>(mesh.vertices.cols()));
  for (const auto& face : mesh.faces.colwise())
    for (int k = 0; k < 2; ++k) components.join(face[k], face[k + 1]);
  const Eigen::VectorXd areas = vertex_areas(mesh);
  const auto count = static_cast<int>(mesh.vertices.cols());
  std::vector<double> component_area(static_cast<std::size_t>(count), 0);
  for (int i = 0; i < count; ++i) component_area[components.least(i)] += areas[i];
  std::vector<char> carries(component_area.size());
  double carried = 0;
  for (int i = 0; i < count; ++i) {
    carries[i] = component_area[components.least(i)] >= spacing * spacing ? 1 : 0;
    if (carries[i]) carried += areas[i];
  }
  if (carried < min_carried_area * areas.sum()) carries.assign(carries.size(), 0);
  return carries;
}

/// A fixed pseudo-random order, so that the thinning does not follow the rows of a regular mesh.
std::vector<int> scattered_order(std::size_t count) {
  std::vector<std::pair<std::uint64_t, int>> keyed(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint64_t x = (i + 1) * 0x9E3779B97F4A7C15u;
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    keyed[i] = {x ^ x >> 31, static_cast<int>(i)};
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<int> order;
  for (const auto& entry : keyed) order.push_back(entry.second);
  return order;
}

struct Sampling {
  std::vector<int> node_vertices;
  std::vector<std::vector<Near>> near;  // per vertex, sorted
};

/// Vertices without a node near them follow the nearest ones in space.
void follow_in_space(const Points& vertices, double first_reach, Sampling& sampling) {
  Points nodes(3, static_cast<Eigen::Index>(sampling.node_vertices.size()));
  for (Eigen::Index k = 0; k < nodes.cols(); ++k) nodes.col(k) = vertices.col(sampling.node_vertices[k]);
  const PointGrid grid(nodes, first_reach);
  constexpr std::size_t grain = 512;
  parallel_for(sampling.near.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::vector<Near>& near = sampling.near[i];
      const Vector3 x = vertices.col(static_cast<Eigen::Index>(i));
      for (double reach = first_reach; near.empty(); reach *= 2) {
        grid.for_each_within(x, reach,
                             [&](int node, double squared) { near.emplace_back(std::sqrt(squared), node); });
        std::sort(near.begin(), near.end());
      }
    }
  });
}

Sampling sample(const TriangleMesh& mesh, double spacing, const NodeSettings& settings) {
  const double reach = settings.follow_reach * spacing;
  Sampling sampling;
  const std::size_t count = static_cast<std::size_t>(mesh.vertices.cols());
  sampling.near.resize(count);
  const std::vector<char> carries = carries_nodes(mesh, spacing, settings.min_carried_area);
  if (std::find(carries.begin(), carries.end(), 1) == carries.end()) {
    sampling.node_vertices = thin_points(mesh.vertices, spacing);
  } else {
    const SurfaceGraph edges = edge_graph(mesh);
    ShortestPaths paths(edges);
    std::vector<char> covered(count, 0);
    for (const int start : scattered_order(count)) {
      if (!carries[start] || covered[start]) continue;
      const int node = static_cast<int>(sampling.node_vertices.size());
      sampling.node_vertices.push_back(start);
      const PathStart from_node{start};
      paths.visit_within({&from_node, 1}, reach, [&](int vertex, double distance) {
        if (distance < spacing) covered[vertex] = 1;
        sampling.near[vertex].emplace_back(distance, node);
      });
    }
    for (auto& near : sampling.near) std::sort(near.begin(), near.end());
  }
  follow_in_space(mesh.vertices, reach, sampling);
  return sampling;
}

void link(std::vector<std::vector<int>>& neighbours, int a, int b) {
  if (std::find(neighbours[a].begin(), neighbours[a].end(), b) != neighbours[a].end()) return;
  neighbours[a].push_back(b);
  neighbours[b].push_back(a);
}

/// The nearest nodes in space, `wanted` of those that `accepts`.
template <class Accepts>
void link_nearest(DeformationNodes& nodes, int node, int wanted, const Accepts& accepts) {
  std::vector<Near> others;
  for (int other = 0; other < nodes.size(); ++other)
    if (other != node && accepts(other))
      others.emplace_back((nodes.rest.col(other) - nodes.rest.col(node)).squaredNorm(), other);
  std::sort(others.begin(), others.end());
  for (int k = 0; k < std::min<int>(wanted, static_cast<int>(others.size())); ++k)
    link(nodes.neighbours, node, others[k].second);
}

/// Nodes with too few neighbours, and components that nothing ties to the rest.
void complete_links(DeformationNodes& nodes, int min_neighbours) {
  for (int node = 0; node < nodes.size(); ++node)
    if (static_cast<int>(nodes.neighbours[node].size()) < min_neighbours)
      link_nearest(nodes, node, min_neighbours, [](int) { return true; });
  DisjointSets tied(nodes.size());
  for (int node = 0; node < nodes.size(); ++node)
    for (const int other : nodes.neighbours[node]) tied.join(node, other);
  for (int node = 1; node < nodes.size(); ++node) {
    if (tied.least(node) != node) continue;  // the first node of a component
    link_nearest(nodes, node, min_neighbours / 2, [&](int other) { return tied.least(other) != node; });
    tied.join(node, nodes.neighbours[node].back());
  }
  for (auto& list : nodes.neighbours) std::sort(list.begin(), list.end());
}

/// Moving least squares of first order (Lancaster, Salkauskas 1981): Shepard's weights, corrected so that
/// linear functions along the surface are reproduced.
void weigh(const TriangleMesh& mesh, const std::vector<Near>& near, const NodeSettings& settings,
           DeformationNodes& nodes, Eigen::Index vertex) {
  const Vector3 x = mesh.vertices.col(vertex);
  const int used = std::min<int>(DeformationNodes::per_vertex, static_cast<int>(near.size()));
  // Nodes fade out before they are dropped: the farthest of the full number, else those at the reach.
  const double farthest = settings.fade_margin * near[used - 1].first;
  const double reach = used < DeformationNodes::per_vertex
                           ? std::max(farthest, settings.follow_reach * nodes.spacing)
                           : farthest;
  Eigen::VectorXd share(used);
  Vector3 mean = Vector3::Zero();
  for (int k = 0; k < used; ++k) {
    const double t = std::max(0.0, 1 - near[k].first / reach);
    share[k] = t * t * t + settings.weight_floor;
  }
  share /= share.sum();
  for (int k = 0; k < used; ++k) mean += share[k] * nodes.rest.col(near[k].second);
  Matrix3 spread = Matrix3::Zero();
  for (int k = 0; k < used; ++k) {
    const Vector3 arm = nodes.rest.col(near[k].second) - mean;
    spread += share[k] * arm * arm.transpose();
  }
  spread.diagonal().array() +=
      settings.flatness * spread.trace() + settings.spread_floor * nodes.spacing * nodes.spacing;
  const Vector3 slope = spread.ldlt().solve(x - mean);
  for (int k = 0; k < used; ++k) {
    nodes.vertex_nodes(k, vertex) = near[k].second;
    nodes.vertex_weights(k, vertex) = share[k] * (1 + slope.dot(nodes.rest.col(near[k].second) - mean));
  }
}

}  // namespace

Vector3 DeformationNodes::displacement(const Points& node_displacements, Eigen::Index vertex) const {
  Vector3 sum = Vector3::Zero();
  for (int k = 0; k < per_vertex; ++k)
    sum += vertex_weights(k, vertex) * node_displacements.col(vertex_nodes(k, vertex));
  return sum;
}

VertexNodes DeformationNodes::at_vertex(int vertex) const {
  VertexNodes followed;
  for (int k = 0; k < per_vertex; ++k)
    if (vertex_weights(k, vertex) != 0)
      followed.nodes[followed.count++] = {vertex_nodes(k, vertex), vertex_weights(k, vertex)};
  return followed;
}

std::vector<NodeWeight> DeformationNodes::at_point(const SurfacePoint& point, const Faces& faces) const {
  std::vector<std::pair<int, double>> all;
  for (int corner = 0; corner < 3; ++corner)
    for (const auto& [node, weight] : at_vertex(faces(corner, point.face)))
      all.emplace_back(node, point.barycentric[corner] * weight);
  std::sort(all.begin(), all.end());
  std::vector<NodeWeight> merged;
  for (const auto& [node, weight] : all) {
    if (!merged.empty() && merged.back().node == node)
      merged.back().weight += weight;
    else
      merged.push_back({node, weight});
  }
  return merged;
}

double node_spacing(double area, int count, const NodeSettings& settings) {
  return std::sqrt(area / count / settings.packing);
}

DeformationNodes make_deformation_nodes(const TriangleMesh& mesh, double spacing,
                                        const NodeSettings& settings) {
  const Sampling sampling = sample(mesh, spacing, settings);
  DeformationNodes nodes;
  nodes.spacing = spacing;
  nodes.vertices = sampling.node_vertices;
  const auto count = static_cast<Eigen::Index>(sampling.node_vertices.size());
  nodes.rest = mesh.vertices(Eigen::all, sampling.node_vertices);
  nodes.neighbours.resize(static_cast<std::size_t>(count));
  for (Eigen::Index k = 0; k < count; ++k) {
    const int vertex = sampling.node_vertices[static_cast<std::size_t>(k)];
    for (const auto& [distance, other] : sampling.near[static_cast<std::size_t>(vertex)])
      if (other != k && distance < settings.neighbour_reach * spacing)
        link(nodes.neighbours, static_cast<int>(k), other);
  }
  complete_links(nodes, settings.min_neighbours);

  const Eigen::VectorXd areas = vertex_areas(mesh);
  nodes.areas = Eigen::VectorXd::Zero(count);
  nodes.vertex_nodes = Eigen::MatrixXi::Zero(DeformationNodes::per_vertex, mesh.vertices.cols());
  nodes.vertex_weights = Eigen::MatrixXd::Zero(DeformationNodes::per_vertex, mesh.vertices.cols());
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const std::vector<Near>& near = sampling.near[static_cast<std::size_t>(i)];
    nodes.areas[near.front().second] += areas[i];
    weigh(mesh, near, settings, nodes, i);
  }
  nodes.areas /= nodes.areas.sum();
  return nodes;
}

std::vector<BendingStencil> bending_stencils(const DeformationNodes& nodes, const Points& places,
                                             const BendingSettings& settings) {
  std::vector<BendingStencil> stencils(static_cast<std::size_t>(nodes.size()));
  const auto fill = [&](int node) {
    BendingStencil& stencil = stencils[node];
    stencil.ids = nodes.neighbours[node];
    stencil.ids.push_back(node);
    const auto count = static_cast<Eigen::Index>(stencil.ids.size());
    Eigen::MatrixXd basis(count, 4);
    Eigen::VectorXd weight(count);
    for (Eigen::Index a = 0; a < count; ++a) {
      const Vector3 arm = (places.col(stencil.ids[a]) - places.col(node)) / nodes.spacing;
      basis.row(a) << 1, arm.transpose();
      weight[a] = std::max(std::exp(-arm.squaredNorm() / settings.squared_width), settings.weight_floor);
    }
    weight /= weight.sum();
    const Eigen::MatrixXd weighted = weight.asDiagonal() * basis;
    Eigen::Matrix4d gram = basis.transpose() * weighted;
    gram.diagonal().tail<3>().array() += settings.slope_penalty;
    stencil.quadratic = -weighted * gram.ldlt().solve(weighted.transpose());
    stencil.quadratic.diagonal() += weight;
  };
  parallel_for(stencils.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t node = begin; node < end; ++node) fill(static_cast<int>(node));
  });
  return stencils;
}

}  // namespace bespoke
