#include "bespoke/alignment/detail/surface_patches.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "bespoke/topology/edge_refinement.h"

namespace bespoke {
namespace {

constexpr double edges_per_spacing = 2;
constexpr double normal_share = 0.7;  // opposite normals count as 1.4 spacings apart

struct VertexShares {
  Eigen::VectorXd areas;  // n, a third of the adjacent faces' areas
  Points normals;         // 3×n, area-weighted, not unit
};

VertexShares vertex_shares(const TriangleMesh& mesh) {
  VertexShares shares{Eigen::VectorXd::Zero(mesh.vertices.cols()), Points::Zero(3, mesh.vertices.cols())};
  for (const auto& face : mesh.faces.colwise()) {
    const Vector3 a = mesh.vertices.col(face[0]);
    const Vector3 normal = (mesh.vertices.col(face[1]) - a).cross(mesh.vertices.col(face[2]) - a) / 2;
    for (const int vertex : face) {
      shares.areas[vertex] += normal.norm() / 3;
      shares.normals.col(vertex) += normal / 3;
    }
  }
  return shares;
}

/// The patch of every vertex with area, -1 elsewhere.
std::vector<int> patches_of_vertices(const Points& vertices, const VertexShares& shares, int count,
                                     double normal_length) {
  const Points normals = shares.normals.colwise().normalized() * normal_length;
  const Eigen::Index size = vertices.cols();
  Eigen::ArrayXd nearest(size);
  std::vector<int> patch(static_cast<std::size_t>(size), -1);
  const Vector3 center = vertices * shares.areas / shares.areas.sum();
  for (Eigen::Index i = 0; i < size; ++i)
    nearest[i] = shares.areas[i] > 0 ? (vertices.col(i) - center).squaredNorm() : -1;
  // Farthest-point sampling, whose seeds are as far apart as their number allows; the first is the vertex
  // farthest from the centre of area, a place that does not depend on the order of the vertices.
  for (int k = 0; k < count; ++k) {
    Eigen::Index seed = 0;
    if (!(nearest.maxCoeff(&seed) > 0)) break;
    if (k == 0)
      for (double& distance : nearest)
        if (distance >= 0) distance = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < size; ++i) {
      const double squared = (vertices.col(i) - vertices.col(seed)).squaredNorm() +
                             (normals.col(i) - normals.col(seed)).squaredNorm();
      if (!(squared < nearest[i])) continue;
      nearest[i] = squared;
      patch[static_cast<std::size_t>(i)] = k;
    }
  }
  return patch;
}

std::vector<std::vector<int>> adjacency(const Faces& faces, const std::vector<int>& patch_of_vertex,
                                        Eigen::Index count) {
  std::vector<std::vector<int>> neighbours(static_cast<std::size_t>(count));
  for (const auto& face : faces.colwise())
    for (int k = 0; k < 3; ++k) {
      const int a = patch_of_vertex[face[k]], b = patch_of_vertex[face[(k + 1) % 3]];
      if (a < 0 || b < 0 || a == b) continue;
      neighbours[a].push_back(b);
      neighbours[b].push_back(a);
    }
  for (std::vector<int>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

/// Ties every component to the one that holds patch 0 by the shortest link, so that nothing floats.
void connect(std::vector<std::vector<int>>& neighbours, const Points& points) {
  const auto count = static_cast<int>(neighbours.size());
  std::vector<char> reached(neighbours.size(), 0);
  std::vector<int> waiting{0};
  reached[0] = 1;
  while (true) {
    while (!waiting.empty()) {
      const int patch = waiting.back();
      waiting.pop_back();
      for (const int other : neighbours[patch])
        if (!std::exchange(reached[other], 1)) waiting.push_back(other);
    }
    std::pair<int, int> link{-1, -1};
    double least = std::numeric_limits<double>::infinity();
    for (int a = 0; a < count; ++a)
      for (int b = 0; b < count; ++b) {
        if (!reached[a] || reached[b]) continue;
        const double squared = (points.col(a) - points.col(b)).squaredNorm();
        if (!(squared < least)) continue;
        least = squared;
        link = {a, b};
      }
    if (link.first < 0) return;
    neighbours[link.first].push_back(link.second);
    neighbours[link.second].push_back(link.first);
    waiting.push_back(link.second);
    reached[link.second] = 1;
  }
}

/// Mean over the neighbours of the curvature of the circle through both that is tangent to the patch.
Eigen::VectorXd mean_curvatures(const SurfacePatches& patches) {
  Eigen::VectorXd curvature = Eigen::VectorXd::Zero(patches.size());
  for (Eigen::Index i = 0; i < patches.size(); ++i) {
    const std::vector<int>& around = patches.neighbours[static_cast<std::size_t>(i)];
    for (const int j : around) {
      const Vector3 edge = patches.points.col(j) - patches.points.col(i);
      curvature[i] -= 2 * edge.dot(patches.normals.col(i)) / edge.squaredNorm() / double(around.size());
    }
  }
  return curvature;
}

void add_moments(SurfacePatches& patches) {
  patches.center = patches.points * patches.open_areas;
  const Points arms = patches.points.colwise() - patches.center;
  const Matrix3 covariance = arms * patches.open_areas.asDiagonal() * arms.transpose();
  patches.radius = std::sqrt(covariance.trace());
  const Eigen::SelfAdjointEigenSolver<Matrix3> solver(covariance);
  patches.axes = solver.eigenvectors().rowwise().reverse();
  if (patches.axes.determinant() < 0) patches.axes.col(2) *= -1;
}

/// Of the refined vertices: a new one is flagged where both ends of its edge are. None where `flags` is
/// empty.
std::vector<char> refined_flags(std::vector<char> flags, const RefinedMesh& refined) {
  flags.resize(static_cast<std::size_t>(refined.mesh.vertices.cols() - refined.parents.cols()), 0);
  for (const auto& ends : refined.parents.colwise()) flags.push_back(flags[ends[0]] && flags[ends[1]]);
  return flags;
}

}  // namespace

double longest_edge_of_patches(const TriangleMesh& mesh, int count) {
  return std::sqrt(vertex_areas(mesh).sum() / count) / edges_per_spacing;
}

SurfacePatches make_surface_patches(const TriangleMesh& mesh, int count, const std::vector<char>& in_cavity) {
  require_valid(mesh, "model to align");
  const double area = vertex_shares(mesh).areas.sum();
  if (!(area > 0)) throw InvalidInput("a model to align has no area");
  SurfacePatches patches;
  patches.spacing = std::sqrt(area / count);
  const RefinedMesh refined = refine_long_edges(mesh, longest_edge_of_patches(mesh, count));
  const TriangleMesh& fine = refined.mesh;
  const VertexShares shares = vertex_shares(fine);
  patches.patch_of_vertex = patches_of_vertices(fine.vertices, shares, count, normal_share * patches.spacing);

  const Eigen::Index size =
      1 + *std::max_element(patches.patch_of_vertex.begin(), patches.patch_of_vertex.end());
  const std::vector<char> fine_in_cavity = refined_flags(in_cavity, refined);
  patches.points = patches.normals = Points::Zero(3, size);
  patches.areas = patches.open_areas = Eigen::VectorXd::Zero(size);
  for (Eigen::Index i = 0; i < fine.vertices.cols(); ++i) {
    const int patch = patches.patch_of_vertex[static_cast<std::size_t>(i)];
    if (patch < 0) continue;
    patches.areas[patch] += shares.areas[i];
    if (!fine_in_cavity[static_cast<std::size_t>(i)]) patches.open_areas[patch] += shares.areas[i];
    patches.points.col(patch) += shares.areas[i] * fine.vertices.col(i);
    patches.normals.col(patch) += shares.normals.col(i);
  }
  patches.points *= patches.areas.cwiseInverse().asDiagonal();
  patches.normals.colwise().normalize();
  patches.areas /= patches.areas.sum();
  patches.open_areas /= patches.open_areas.sum();
  patches.on_boundary = Eigen::VectorXd::Zero(size);
  const std::vector<char> boundary = boundary_vertices(fine);
  for (std::size_t i = 0; i < boundary.size(); ++i)
    if (boundary[i] && patches.patch_of_vertex[i] >= 0) patches.on_boundary[patches.patch_of_vertex[i]] = 1;
  patches.neighbours = adjacency(fine.faces, patches.patch_of_vertex, size);
  connect(patches.neighbours, patches.points);
  patches.patch_of_vertex.resize(static_cast<std::size_t>(mesh.vertices.cols()));
  add_moments(patches);
  patches.curvature = mean_curvatures(patches) * patches.radius;
  return patches;
}

SurfacePatches mirrored(SurfacePatches patches) {
  patches.points.row(0) *= -1;
  patches.normals.row(0) *= -1;
  patches.center[0] *= -1;
  patches.axes.row(0) *= -1;
  patches.axes.col(2) *= -1;
  return patches;
}

}  // namespace bespoke
