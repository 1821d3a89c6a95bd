#include "bespoke/pattern/sheet/grain.h"

#include <vector>

namespace bespoke {
namespace {

/// Columns: the second and third corner from the first.
template <class Columns>
auto corner_edges(const Columns& columns, const Eigen::Vector3i& face) {
  Eigen::Matrix<double, Columns::RowsAtCompileTime, 2> edges;
  edges << columns.col(face[1]) - columns.col(face[0]), columns.col(face[2]) - columns.col(face[0]);
  return edges;
}

Eigen::Vector2d unit(const Eigen::Vector2d& sum) {
  return sum.norm() > 0 ? Eigen::Vector2d(sum.normalized()) : Eigen::Vector2d(0, 1);
}

}  // namespace

Eigen::Vector2d grain_of_charts(const Piece& piece, const Eigen::Matrix2Xd& flat) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
    const Eigen::Matrix2d chart = corner_edges(
        piece.texture,
        Eigen::Vector3i(3 * static_cast<int>(f), 3 * static_cast<int>(f) + 1, 3 * static_cast<int>(f) + 2));
    const Eigen::Matrix2d plane = corner_edges(flat, piece.mesh.faces.col(f));
    if (chart.determinant() == 0) continue;
    const Eigen::Vector2d along = plane * chart.inverse() * Eigen::Vector2d(0, 1);
    if (along.norm() > 0) sum += plane.determinant() * along.normalized();
  }
  return unit(sum);
}

Eigen::Vector2d grain_along(const Piece& piece, const Eigen::Matrix2Xd& flat, const Vector3& direction) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
    const Eigen::Vector3i face = piece.mesh.faces.col(f);
    const Eigen::Matrix2d plane = corner_edges(flat, face);
    const Eigen::Vector2d heights = corner_edges(piece.mesh.vertices, face).transpose() * direction;
    sum += plane.determinant() * (plane.transpose().inverse() * heights);
  }
  return unit(sum);
}

Eigen::Vector2d carried_grain(const Piece& source, const Eigen::Matrix2Xd& source_flat,
                              const Eigen::Vector2d& source_grain, const Eigen::Matrix2Xd& flat) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index f = 0; f < source.mesh.faces.cols(); ++f) {
    const Eigen::Vector3i face = source.mesh.faces.col(f);
    const Eigen::Matrix2d before = corner_edges(source_flat, face), after = corner_edges(flat, face);
    sum += after.determinant() * (after * before.inverse() * source_grain).normalized();
  }
  return unit(sum);
}

}  // namespace bespoke
