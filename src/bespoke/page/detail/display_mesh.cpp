#include "bespoke/page/detail/display_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

#include "bespoke/error.h"
#include "bespoke/topology/decimation.h"

namespace bespoke {
namespace {

using Cube = std::array<int, 3>;

/// Which cube of a grid every vertex lies in, cubes numbered in their order.
struct Cubes {
  std::vector<int> of_vertex;
  int count = 0;
};

Cubes cubes_of(const Points& vertices, double edge) {
  const Vector3 low = bounding_box(vertices).min();
  std::vector<Cube> cubes;
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const Vector3 at = ((vertices.col(i) - low) / edge).array().floor();
    cubes.push_back({static_cast<int>(at.x()), static_cast<int>(at.y()), static_cast<int>(at.z())});
  }
  std::map<Cube, int> numbers;
  for (const Cube& cube : cubes) numbers.emplace(cube, 0);
  int next = 0;
  for (auto& [cube, number] : numbers) number = next++;
  Cubes result{{}, next};
  for (const Cube& cube : cubes) result.of_vertex.push_back(numbers.at(cube));
  return result;
}

/// The triangles whose corners lie in three cubes, those cubes' numbers in place of the vertices', each once.
std::vector<Cube> faces_between(const Cubes& cubes, const Faces& faces) {
  std::vector<Cube> kept;
  for (Eigen::Index f = 0; f < faces.cols(); ++f) {
    Cube face;
    for (int k = 0; k < 3; ++k)
      face[static_cast<std::size_t>(k)] = cubes.of_vertex[static_cast<std::size_t>(faces(k, f))];
    if (face[0] == face[1] || face[1] == face[2] || face[2] == face[0]) continue;
    // The same orientation, the least corner first, so that equal triangles are found.
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    kept.push_back(face);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  return kept;
}

/// Of every cube the vertex nearest to the mean of its vertices.
std::vector<int> representatives(const Cubes& cubes, const Points& vertices) {
  Points mean = Points::Zero(3, cubes.count);
  std::vector<int> members(static_cast<std::size_t>(cubes.count));
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const int cube = cubes.of_vertex[static_cast<std::size_t>(i)];
    mean.col(cube) += vertices.col(i);
    ++members[static_cast<std::size_t>(cube)];
  }
  std::vector<int> nearest(static_cast<std::size_t>(cubes.count));
  std::vector<double> distance(nearest.size(), std::numeric_limits<double>::infinity());
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const auto cube = static_cast<std::size_t>(cubes.of_vertex[static_cast<std::size_t>(i)]);
    const double own =
        (mean.col(static_cast<Eigen::Index>(cube)) / members[cube] - vertices.col(i)).squaredNorm();
    if (!(own < distance[cube])) continue;
    distance[cube] = own;
    nearest[cube] = static_cast<int>(i);
  }
  return nearest;
}

DisplayMesh thinned(const TriangleMesh& mesh, const Cubes& cubes) {
  const std::vector<int> vertex_of_cube = representatives(cubes, mesh.vertices);
  const std::vector<Cube> faces = faces_between(cubes, mesh.faces);
  DisplayMesh display;
  display.is_whole = false;
  display.original = vertex_of_cube;
  std::sort(display.original.begin(), display.original.end());
  std::map<int, int> shown;
  for (std::size_t i = 0; i < display.original.size(); ++i) shown[display.original[i]] = static_cast<int>(i);
  display.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t f = 0; f < faces.size(); ++f)
    for (std::size_t k = 0; k < 3; ++k)
      display.faces(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(f)) =
          shown.at(vertex_of_cube[static_cast<std::size_t>(faces[f][k])]);
  return display;
}

}  // namespace

Points DisplayMesh::shown(const Points& of_all) const { return of_all(Eigen::all, original); }

DisplayMesh display_mesh(const TriangleMesh& mesh, std::size_t max_faces) {
  inspect_mesh(mesh);  // refuses indices out of range
  const bool has_faces = mesh.faces.cols() > 0;
  const auto size = static_cast<std::size_t>(has_faces ? mesh.faces.cols() : mesh.vertices.cols());
  if (size <= max_faces) {
    DisplayMesh whole{std::vector<int>(static_cast<std::size_t>(mesh.vertices.cols())), mesh.faces};
    std::iota(whole.original.begin(), whole.original.end(), 0);
    return whole;
  }
  if (has_faces)
    if (const DecimatedMesh fewer = decimated(mesh, max_faces);
        static_cast<std::size_t>(fewer.mesh.faces.cols()) <= max_faces)
      return {fewer.vertices, fewer.mesh.faces, false};
  // Points, or triangles that share too few edges to collapse. A surface of n triangles crosses about n / 2
  // cubes. From there the grid gets coarser until few enough are left.
  const double extent = diagonal(mesh.vertices);
  double edge = extent / std::sqrt(static_cast<double>(max_faces));
  constexpr double coarser = 1.08;
  for (;; edge *= coarser) {
    const Cubes cubes = cubes_of(mesh.vertices, edge);
    const std::size_t left =
        has_faces ? faces_between(cubes, mesh.faces).size() : static_cast<std::size_t>(cubes.count);
    if (left <= max_faces) return thinned(mesh, cubes);
  }
}

}  // namespace bespoke
