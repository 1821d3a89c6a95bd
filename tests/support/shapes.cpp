#include "support/shapes.h"

#include <cmath>
#include <map>
#include <numeric>
#include <utility>

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
  TriangleMesh mesh;
  mesh.vertices = Points{{-1, 1, -1, 1, 0, 0, 0, 0, g, g, -g, -g},
                         {g, g, -g, -g, -1, 1, -1, 1, 0, 0, 0, 0},
                         {0, 0, 0, 0, g, g, -g, -g, -1, 1, -1, 1}}
                      .colwise()
                      .normalized();
  mesh.faces = Faces{{0, 0, 0, 0, 0, 1, 5, 11, 10, 7, 3, 3, 3, 3, 3, 4, 2, 6, 8, 9},
                     {11, 5, 1, 7, 10, 5, 11, 10, 7, 1, 9, 4, 2, 6, 8, 9, 4, 2, 6, 8},
                     {5, 1, 7, 10, 11, 9, 4, 2, 6, 8, 4, 2, 6, 8, 9, 5, 11, 10, 7, 1}};
  for (int level = 0; level < levels; ++level) {
    mesh = subdivided(mesh);
    mesh.vertices.colwise().normalize();
  }
  return mesh;
}

TriangleMesh subdivided(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> middles;
  const auto first = static_cast<int>(mesh.vertices.cols());
  const auto middle = [&](int a, int b) {
    return middles.try_emplace(std::minmax(a, b), first + static_cast<int>(middles.size())).first->second;
  };
  TriangleMesh finer;
  finer.faces.resize(3, 4 * mesh.faces.cols());
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
    const int a = mesh.faces(0, f), b = mesh.faces(1, f), c = mesh.faces(2, f);
    const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    finer.faces.middleCols<4>(4 * f) << a, b, c, ab,  //
        ab, bc, ca, bc,                               //
        ca, ab, bc, ca;
  }
  finer.vertices.resize(3, first + static_cast<Eigen::Index>(middles.size()));
  finer.vertices.leftCols(first) = mesh.vertices;
  for (const auto& [edge, vertex] : middles)
    finer.vertices.col(vertex) = (mesh.vertices.col(edge.first) + mesh.vertices.col(edge.second)) / 2;
  return finer;
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

TriangleMesh soup(const TriangleMesh& mesh) {
  TriangleMesh result{mesh.vertices(Eigen::all, mesh.faces.reshaped()), mesh.faces};
  std::iota(result.faces.reshaped().begin(), result.faces.reshaped().end(), 0);
  return result;
}

TriangleMesh of_unit_diagonal(TriangleMesh mesh) {
  mesh.vertices /= diagonal(mesh.vertices);
  return mesh;
}

TriangleMesh moved(TriangleMesh mesh, const AffineMap& map) {
  mesh.vertices = map * mesh.vertices;
  return mesh;
}

}  // namespace bespoke::shapes
