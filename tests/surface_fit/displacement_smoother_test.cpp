#include "bespoke/surface_fit/detail/displacement_smoother.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "bespoke/error.h"
#include "bespoke/mesh/mesh_edges.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using test::random_points;

/// Eq. 11, summed as it is written.
struct Energy {
  TriangleMesh mesh;
  std::vector<DisplacementAnchor> anchors;
  double stiffness = 1;
  Points wished;
  std::vector<char> matched;
  Points anchor_wished;

  double operator()(const Points& displacement) const {
    double energy = 0;
    const VertexAdjacency adjacency = vertex_adjacency(mesh);
    for (int i = 0; i < displacement.cols(); ++i) {
      if (matched[static_cast<std::size_t>(i)]) energy += (displacement.col(i) - wished.col(i)).squaredNorm();
      for (int k = adjacency.start[static_cast<std::size_t>(i)];
           k < adjacency.start[static_cast<std::size_t>(i) + 1]; ++k) {
        const int j = adjacency.neighbours[static_cast<std::size_t>(k)];
        if (i < j) energy += stiffness * (displacement.col(i) - displacement.col(j)).squaredNorm();
      }
    }
    for (std::size_t k = 0; k < anchors.size(); ++k) {
      Vector3 at = Vector3::Zero();
      for (int corner = 0; corner < 3; ++corner)
        at += anchors[k].barycentric[corner] * displacement.col(anchors[k].vertices[corner]);
      energy += anchors[k].weight * (at - anchor_wished.col(static_cast<Eigen::Index>(k))).squaredNorm();
    }
    return energy;
  }
};

Energy energy_on(const TriangleMesh& mesh, double stiffness) {
  Energy energy;
  energy.mesh = mesh;
  energy.stiffness = stiffness;
  energy.wished = random_points(mesh.vertices.cols(), 1);
  energy.matched.assign(static_cast<std::size_t>(mesh.vertices.cols()), 1);
  energy.anchor_wished.resize(3, 0);
  return energy;
}

/// The energy is quadratic, so that central differences of step 1 give its gradient exactly.
double largest_gradient(const Energy& energy, Points at) {
  double largest = 0;
  for (Eigen::Index i = 0; i < at.size(); ++i) {
    const double value = at(i);
    at(i) = value + 1;
    const double above = energy(at);
    at(i) = value - 1;
    const double below = energy(at);
    at(i) = value;
    largest = std::max(largest, std::abs(above - below) / 2);
  }
  return largest;
}

TEST(DisplacementSmoother, SolvesForTheMinimumOfTheEnergy) {
  for (const double stiffness : {0.0, 1.0, 40.0}) {
    Energy energy = energy_on(shapes::square_grid(5), stiffness);
    energy.anchors = {{energy.mesh.faces.col(7), Vector3(0.2, 0.3, 0.5), 10}};
    energy.anchor_wished = Vector3(1, 2, 3);
    const DisplacementSmoother smoother(energy.mesh, energy.anchors, stiffness);
    const Points solution = smoother.solve(energy.wished, energy.matched, energy.anchor_wished);
    EXPECT_LT(largest_gradient(energy, solution), 1e-9);
  }
}

TEST(DisplacementSmoother, EqualsTheDenseSolutionOfTheEquation) {
  const Energy energy = energy_on(shapes::icosphere(1), 1);
  const VertexAdjacency adjacency = vertex_adjacency(energy.mesh);
  const Eigen::Index count = energy.mesh.vertices.cols();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (int k = adjacency.start[static_cast<std::size_t>(i)];
         k < adjacency.start[static_cast<std::size_t>(i) + 1]; ++k) {
      matrix(i, i) += 1;
      matrix(i, adjacency.neighbours[static_cast<std::size_t>(k)]) -= 1;
    }
  const Points dense = matrix.fullPivLu().solve(energy.wished.transpose()).transpose();
  const DisplacementSmoother smoother(energy.mesh, {}, 1);
  EXPECT_TRUE(smoother.solve(energy.wished, energy.matched, energy.anchor_wished).isApprox(dense, 1e-12));
}

TEST(DisplacementSmoother, LeavesUnmatchedVerticesToTheirNeighbours) {
  Energy energy = energy_on(shapes::square_grid(6), 3);
  for (std::size_t i = 0; i < energy.matched.size(); i += 2) energy.matched[i] = 0;
  const DisplacementSmoother smoother(energy.mesh, {}, 3);
  const Points solution = smoother.solve(energy.wished, energy.matched, energy.anchor_wished);
  EXPECT_LT(largest_gradient(energy, solution), 1e-4);
}

TEST(DisplacementSmoother, KeepsConstantDisplacements) {
  Energy energy = energy_on(shapes::joined(shapes::icosphere(2), shapes::square_grid(3)), 100);
  energy.wished.colwise() = Vector3(1, -2, 3);
  energy.matched[5] = energy.matched[17] = 0;
  const DisplacementSmoother smoother(energy.mesh, {}, 100);
  EXPECT_LT((smoother.solve(energy.wished, energy.matched, energy.anchor_wished) - energy.wished).norm(),
            1e-4);
}

TEST(DisplacementSmoother, LeavesAPieceWithoutAnyMatchAlone) {
  Energy energy = energy_on(shapes::joined(shapes::square_grid(2), shapes::square_grid(2)), 2);
  for (std::size_t i = 9; i < 18; ++i) energy.matched[i] = 0;
  const DisplacementSmoother smoother(energy.mesh, {}, 2);
  EXPECT_LT(smoother.solve(energy.wished, energy.matched, energy.anchor_wished).rightCols(9).norm(), 1e-12);
}

TEST(DisplacementSmoother, RejectsAStiffnessThatIsNone) {
  EXPECT_THROW(DisplacementSmoother(shapes::triangle(), {}, -1), InvalidInput);
  EXPECT_THROW(DisplacementSmoother(shapes::triangle(), {}, std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace bespoke
