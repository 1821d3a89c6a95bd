#include "support/shapes.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace bespoke::shapes {

TriangleMesh triangle() {
  TriangleMesh mesh;
  mesh.vertices = Points{{0, 1, 0}, {0, 0, 1}, {0, 0, 0}};
  mesh.faces = Faces{{0}, {1}, {2}};
  return mesh;
}

TriangleMesh cube(double edge) {
  TriangleMesh mesh;
  mesh.vertices = edge * Points{{0, 1, 0, 1, 0, 1, 0, 1}, {0, 0, 1, 1, 0, 0, 1, 1}, {0, 0, 0, 0, 1, 1, 1, 1}};
  mesh.faces = Faces{{0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1},
                     {2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7},
                     {3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5}};
  return mesh;
}

TriangleMesh icosphere(int levels) {
  const double g = (1 + std::sqrt(5.0)) / 2;
  std::vector<Vector3> vertices{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                                {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  for (Vector3& vertex : vertices) vertex.normalize();
  std::vector<Eigen::Vector3i> faces{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [at, added] = middles.try_emplace(std::minmax(a, b), static_cast<int>(vertices.size()));
      if (added)
        vertices.push_back(
            (vertices[static_cast<std::size_t>(a)] + vertices[static_cast<std::size_t>(b)]).normalized());
      return at->second;
    };
    std::vector<Eigen::Vector3i> finer;
    for (const Eigen::Vector3i& face : faces) {
      const int ab = middle(face(0), face(1)), bc = middle(face(1), face(2)), ca = middle(face(2), face(0));
      finer.push_back({face(0), ab, ca});
      finer.push_back({face(1), bc, ab});
      finer.push_back({face(2), ca, bc});
      finer.push_back({ab, bc, ca});
    }
    faces = std::move(finer);
  }
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  for (std::size_t i = 0; i < vertices.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = vertices[i];
  mesh.faces.resize(3, static_cast<Eigen::Index>(faces.size()));
  for (std::size_t i = 0; i < faces.size(); ++i) mesh.faces.col(static_cast<Eigen::Index>(i)) = faces[i];
  return mesh;
}

TriangleMesh square_grid(int n) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, (n + 1) * (n + 1));
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i)
      mesh.vertices.col(j * (n + 1) + i) = Vector3(static_cast<double>(i) / n, static_cast<double>(j) / n, 0);
  mesh.faces.resize(3, 2 * n * n);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const int corner = j * (n + 1) + i, square = j * n + i;
      mesh.faces.col(2 * square) = Eigen::Vector3i(corner, corner + 1, corner + n + 2);
      mesh.faces.col(2 * square + 1) = Eigen::Vector3i(corner, corner + n + 2, corner + n + 1);
    }
  return mesh;
}

TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, a.vertices.cols() + b.vertices.cols());
  mesh.vertices << a.vertices, b.vertices;
  mesh.faces.resize(3, a.faces.cols() + b.faces.cols());
  mesh.faces << a.faces, (b.faces.array() + static_cast<int>(a.vertices.cols())).matrix();
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, const AffineMap& map) {
  mesh.vertices = map * mesh.vertices;
  return mesh;
}

}  // namespace bespoke::shapes
