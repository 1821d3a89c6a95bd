#include "bespoke/pattern/flattening/barrier_descent.h"

#include <gtest/gtest.h>

#include "bespoke/pattern/flattening/flat_start.h"
#include "pattern/bent_cloth.h"
#include "pattern/mesh_parts.h"

namespace bespoke {
namespace {

/// Σ area (|J|² + |J⁻¹|²).
double symmetric_dirichlet(const Piece& piece, const std::vector<RestFace>& rest,
                           const Eigen::Matrix2Xd& flat) {
  double sum = 0;
  for (Eigen::Index f = 0; f < piece.mesh.faces.cols(); ++f) {
    const Eigen::Matrix2d jacobian =
        face_jacobian(rest[static_cast<std::size_t>(f)], piece.mesh.faces.col(f), flat);
    sum +=
        rest[static_cast<std::size_t>(f)].area * (jacobian.squaredNorm() + jacobian.inverse().squaredNorm());
  }
  return sum;
}

double area_of(const std::vector<RestFace>& rest) {
  double area = 0;
  for (const RestFace& face : rest) area += face.area;
  return area;
}

/// A ball of which only a cap below is missing: its faces collapse where lengths are to be kept.
Piece nearly_closed_ball() {
  return test::piece_of(test::part_of(test::ball(), [](const Vector3& x) { return x.y() > -90; }).mesh);
}

// The energy is 4 times the area where nothing is stretched, and more everywhere else.
TEST(BarrierDescent, FindsBentClothFromASqueezedStart) {
  const test::BentCloth cloth = test::cylinder_cloth(20);
  const std::vector<RestFace> rest = rest_faces(cloth.piece.mesh);
  const Eigen::Matrix2Xd start = Eigen::Vector2d(1.3, 0.6).asDiagonal() * cloth.flat;
  ASSERT_GT(symmetric_dirichlet(cloth.piece, rest, start), 5 * area_of(rest));
  const Eigen::Matrix2Xd flat = barrier_descent(cloth.piece, rest, start);
  EXPECT_NEAR(symmetric_dirichlet(cloth.piece, rest, flat), 4 * area_of(rest), 1e-3 * area_of(rest));
}

TEST(BarrierDescent, LowersTheEnergyAndFlipsNoFace) {
  const Piece piece = nearly_closed_ball();
  const std::vector<RestFace> rest = rest_faces(piece.mesh);
  const Eigen::Matrix2Xd start = tutte_start(piece, rest);
  const Eigen::Matrix2Xd flat = barrier_descent(piece, rest, start);
  EXPECT_TRUE(is_unflipped(piece.mesh, rest, flat));
  EXPECT_LT(symmetric_dirichlet(piece, rest, flat), 0.5 * symmetric_dirichlet(piece, rest, start));
}

// Where the descent ends, a random motion of all vertices hardly changes the energy in first order.
TEST(BarrierDescent, EndsWhereTheEnergyIsStationary) {
  const Piece piece = nearly_closed_ball();
  const std::vector<RestFace> rest = rest_faces(piece.mesh);
  const Eigen::Matrix2Xd start = tutte_start(piece, rest);
  const Eigen::Matrix2Xd end = barrier_descent(piece, rest, start);
  const auto slope = [&](const Eigen::Matrix2Xd& at, const Eigen::Matrix2Xd& along) {
    const double step = 1e-4 / along.norm();
    return (symmetric_dirichlet(piece, rest, at + step * along) -
            symmetric_dirichlet(piece, rest, at - step * along)) /
           2e-4;
  };
  // Along the way from the start to the end the slope fell to nearly none.
  EXPECT_LT(std::abs(slope(end, end - start)), 0.01 * std::abs(slope(start, end - start)));
}

TEST(BarrierDescent, MovesNothingThatIsFlatAlready) {
  const test::BentCloth cloth = test::cylinder_cloth();
  const std::vector<RestFace> rest = rest_faces(cloth.piece.mesh);
  const Eigen::Matrix2Xd flat = barrier_descent(cloth.piece, rest, cloth.flat);
  EXPECT_LT(test::shape_difference(flat, cloth.flat), 1e-6 * diagonal(cloth.piece.mesh.vertices));
}

}  // namespace
}  // namespace bespoke
