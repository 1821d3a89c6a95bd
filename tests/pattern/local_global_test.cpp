#include "bespoke/pattern/flattening/local_global.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

#include "bespoke/pattern/cut_pieces.h"
#include "bespoke/pattern/flattening/paired_seams.h"
#include "pattern/bent_cloth.h"
#include "pattern/mesh_parts.h"

namespace bespoke {
namespace {

constexpr double seam_weight = 3;

/// Two halves of a cap of a ball, which are sewn together; no flat shape keeps their lengths.
struct Halves {
  Halves() {
    for (const bool is_left : {true, false})
      pieces.push_back(test::piece_of(test::part_of(test::ball(), [&](const Vector3& at) {
                                        return at.y() > 40 && (at.x() < 0) == is_left;
                                      }).mesh));
    // Any two runs of equally many vertices will do.
    seams.push_back({{SeamSide{0, run(0)}, SeamSide{1, run(1)}}, 4});
    problem.emplace(pieces, seams, FlatteningMethod::rigid);
    problem->set_seam_weight(seam_weight);
    std::mt19937 random(11);
    std::normal_distribution<double> noise(0, 0.5);
    std::vector<Eigen::Matrix2Xd> flat;
    for (const Piece& piece : pieces) {
      flat.emplace_back(piece.mesh.vertices(std::vector<int>{0, 2}, Eigen::all));
      flat.back().row(0) *= -1;  // seen from above
      for (double& value : flat.back().reshaped()) value += noise(random);
    }
    x = problem->joined(flat);
  }

  std::vector<int> run(std::size_t piece) const {
    const std::vector<int>& outline = pieces[piece].outline;
    return {outline.begin(), outline.begin() + 6};
  }

  /// Of the vertices that move: 2×N, 0 at the first of each outline.
  FlatState direction(unsigned seed) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    FlatState v(2, x.cols());
    for (double& value : v.reshaped()) value = normal(random);
    v.col(pieces[0].outline[0]).setZero();
    v.col(pieces[0].mesh.vertices.cols() + pieces[1].outline[0]).setZero();
    return v;
  }

  /// The energy at y with the targets of the local step at x: of faces the nearest rotations, by singular
  /// values; of the paired edges the nearest two whose lengths differ by the ease.
  double proxy(const FlatState& y) const {
    double sum = 0;
    const std::vector<Eigen::Matrix2Xd> of_x = problem->parted(x), of_y = problem->parted(y);
    for (std::size_t p = 0; p < pieces.size(); ++p) {
      const TriangleMesh& mesh = pieces[p].mesh;
      const std::vector<RestFace> rest = rest_faces(mesh);
      for (Eigen::Index f = 0; f < mesh.faces.cols(); ++f) {
        const RestFace& face = rest[static_cast<std::size_t>(f)];
        const Eigen::JacobiSVD<Eigen::Matrix2d> svd(face_jacobian(face, mesh.faces.col(f), of_x[p]),
                                                    Eigen::ComputeFullU | Eigen::ComputeFullV);
        const Eigen::Vector2d signs(1, (svd.matrixU() * svd.matrixV()).determinant());
        const Eigen::Matrix2d nearest = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
        sum += face.area * (face_jacobian(face, mesh.faces.col(f), of_y[p]) - nearest).squaredNorm();
      }
    }
    const Seam& seam = seams[0];
    const auto edge = [&](const std::vector<Eigen::Matrix2Xd>& flat, std::size_t side, std::size_t k) {
      const std::vector<int>& run = seam.sides[side].vertices;
      return Eigen::Vector2d(flat[side].col(run[k + 1]) - flat[side].col(run[k]));
    };
    const Points& surface = pieces[0].mesh.vertices;
    const std::vector<int>& first = seam.sides[0].vertices;
    for (std::size_t k = 0; k + 1 < first.size(); ++k) {
      const double share =
          (surface.col(first[k + 1]) - surface.col(first[k])).norm() / side_length(seam.sides[0], surface);
      const double one = edge(of_x, 0, k).norm(), other = edge(of_x, 1, k).norm();
      const double gap = one - other - share * seam.ease;
      sum +=
          seam_weight * ((edge(of_y, 0, k) - edge(of_x, 0, k) * ((one - gap / 2) / one)).squaredNorm() +
                         (edge(of_y, 1, k) - edge(of_x, 1, k) * ((other + gap / 2) / other)).squaredNorm());
    }
    return sum;
  }

  std::vector<Piece> pieces;
  std::vector<Seam> seams;
  std::optional<LocalGlobal> problem;
  FlatState x;
};

// The local step is the minimum over the targets: there the energy is the proxy, in value and in slope.
TEST(LocalGlobal, LocalStepTouchesTheEnergy) {
  const Halves halves;
  const double energy = halves.problem->energy(halves.x);
  EXPECT_NEAR(halves.proxy(halves.x), energy, 1e-10 * energy);
  constexpr double step = 1e-5;
  for (const unsigned seed : {1u, 2u, 3u}) {
    const FlatState v = halves.direction(seed);
    const double slope =
        (halves.problem->energy(halves.x + step * v) - halves.problem->energy(halves.x - step * v)) /
        (2 * step);
    const double of_proxy =
        (halves.proxy(halves.x + step * v) - halves.proxy(halves.x - step * v)) / (2 * step);
    EXPECT_NEAR(slope, of_proxy, 1e-5 * std::abs(of_proxy));
  }
}

// The proxy is quadratic, so its central differences are exact however long the step.
TEST(LocalGlobal, GlobalStepIsTheProxysMinimum) {
  const Halves halves;
  const FlatState next = halves.problem->next(halves.x);
  EXPECT_EQ(next.col(halves.pieces[0].outline[0]), halves.x.col(halves.pieces[0].outline[0]));
  for (const unsigned seed : {4u, 5u, 6u}) {
    const FlatState v = halves.direction(seed);
    const double up = halves.proxy(next + v), down = halves.proxy(next - v), at = halves.proxy(next);
    EXPECT_GT(up, at);
    EXPECT_NEAR(up, down, 1e-9 * (up - at));
  }
  EXPECT_LT(halves.problem->energy(next), halves.problem->energy(halves.x));
}

}  // namespace
}  // namespace bespoke
