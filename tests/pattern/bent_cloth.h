#pragma once

#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "bespoke/pattern/piece.h"
#include "bespoke/topology/half_edge_mesh.h"

namespace bespoke::test {

/// A piece before and after it was bent: an isometry of every face.
struct BentCloth {
  Piece piece;
  Eigen::Matrix2Xd flat;  ///< 2×n, millimetres
};

/// A piece of one mesh, which is a disk.
inline Piece piece_of(TriangleMesh mesh) {
  Piece piece;
  piece.name = "piece";
  piece.outline = boundary_loops(half_edge_mesh(mesh)).at(0);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) piece.vertices.push_back(static_cast<int>(v));
  for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) piece.faces.push_back(static_cast<int>(f));
  piece.mesh = std::move(mesh);
  return piece;
}

/// columns × rows vertices: column k of them on the line `from[k]` to `to[k]`, at uneven places.
inline BentCloth ruled_cloth(const std::vector<Eigen::Vector2d>& from, const std::vector<Eigen::Vector2d>& to,
                             int rows) {
  const int columns = static_cast<int>(from.size());
  BentCloth cloth;
  cloth.flat.resize(2, columns * rows);
  TriangleMesh mesh;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.3, 0.3);
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r) {
      const double off = r == 0 || r == rows - 1 ? 0 : shift(random);
      const auto k = static_cast<std::size_t>(c);
      cloth.flat.col(c * rows + r) = from[k] + (to[k] - from[k]) * ((r + off) / (rows - 1));
    }
  mesh.faces.resize(3, 2 * (columns - 1) * (rows - 1));
  Eigen::Index face = 0;
  for (int c = 0; c + 1 < columns; ++c)
    for (int r = 0; r + 1 < rows; ++r) {
      const int a = c * rows + r, b = a + rows;
      mesh.faces.col(face++) << a, b, a + 1;
      mesh.faces.col(face++) << a + 1, b, b + 1;
    }
  mesh.vertices = Points::Zero(3, cloth.flat.cols());
  mesh.vertices.topRows<2>() = cloth.flat;
  cloth.piece = piece_of(std::move(mesh));
  return cloth;
}

/// Folds along every inner column by its angle (radians): columns after it turn about its line.
inline BentCloth folded(BentCloth cloth, int rows, const std::vector<double>& angles) {
  Points& x = cloth.piece.mesh.vertices;
  const int columns = static_cast<int>(x.cols()) / rows;
  for (int c = columns - 2; c > 0; --c) {
    const Vector3 origin = x.col(c * rows), end = x.col(c * rows + rows - 1);
    const Matrix3 turn = Eigen::AngleAxisd(angles[static_cast<std::size_t>(c)], (end - origin).normalized())
                             .toRotationMatrix();
    for (Eigen::Index v = (c + 1) * rows; v < x.cols(); ++v) x.col(v) = origin + turn * (x.col(v) - origin);
  }
  return cloth;
}

inline std::vector<double> equal_angles(int columns, double whole) {
  return std::vector<double>(static_cast<std::size_t>(columns), whole / columns);
}

/// 400 mm × 250 mm of cloth, its columns at uneven places and `slant` millimetres askew, bent by 0.8 · 2π.
inline BentCloth cylinder_cloth(double slant = 0, int columns = 40, int rows = 12) {
  std::vector<Eigen::Vector2d> from, to;
  for (int c = 0; c < columns; ++c) {
    const double x = 400.0 * c / (columns - 1) + 3 * std::sin(5.0 * c);
    from.emplace_back(x, 0);
    to.emplace_back(x + slant, 250);
  }
  return folded(ruled_cloth(from, to, rows), rows, equal_angles(columns, 5.0));
}

/// A sector of an annulus, bent to a cone.
inline BentCloth cone_cloth(int columns = 40, int rows = 12) {
  std::vector<Eigen::Vector2d> from, to;
  for (int c = 0; c < columns; ++c) {
    const double angle = 2.0 * c / (columns - 1);
    to.push_back(100 * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    from.push_back(350 * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return folded(ruled_cloth(from, to, rows), rows, equal_angles(columns, 4.0));
}

/// The largest distance that is left after the motion of least squares.
inline double shape_difference(const Eigen::Matrix2Xd& flat, const Eigen::Matrix2Xd& truth) {
  const Eigen::Matrix2Xd from = flat.colwise() - flat.rowwise().mean();
  const Eigen::Matrix2Xd to = truth.colwise() - truth.rowwise().mean();
  const double along = (from.array() * to.array()).sum();
  const double across =
      (from.row(0).array() * to.row(1).array() - from.row(1).array() * to.row(0).array()).sum();
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(std::atan2(across, along)).toRotationMatrix();
  return std::sqrt((turn * from - to).colwise().squaredNorm().maxCoeff());
}

}  // namespace bespoke::test
