#include "bespoke/surface_fit/matching/informative_areas.h"

#include <gtest/gtest.h>

#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr AreaSettings unit_length{.length = 1};

TriangleMesh sphere(double radius) {
  return shapes::moved(shapes::icosphere(4), {radius * Matrix3::Identity(), Vector3(5 * radius, 0, 0)});
}

TEST(InformativeAreas, AreTheAreasWhereAllIsBentAlike) {
  for (const TriangleMesh& mesh : {shapes::square_grid(5), sphere(1), sphere(0.1)}) {
    const Eigen::VectorXd areas = vertex_areas(mesh);
    const Eigen::VectorXd informative = informative_areas(TargetSurface(mesh), unit_length);
    EXPECT_NEAR(informative.sum(), areas.sum(), 1e-12 * areas.sum());
    EXPECT_LT((informative.cwiseQuotient(areas).array() - 1).abs().maxCoeff(), 0.02);
  }
}

TEST(InformativeAreas, GrowWithTheSquaredCurvatureUpToALimit) {
  for (const auto& [radius, factor] : {std::pair{1.0, 2.0}, {0.5, 5.0}, {0.1, 5.0}, {3.0, 1 + 1 / 9.0}}) {
    const TriangleMesh bent = sphere(radius), flat = shapes::square_grid(5);
    const TriangleMesh both = shapes::joined(bent, flat);
    const Eigen::VectorXd ratio =
        informative_areas(TargetSurface(both), unit_length).cwiseQuotient(vertex_areas(both));
    const double of_flat = ratio.tail(flat.vertices.cols()).mean();
    EXPECT_NEAR(ratio.head(bent.vertices.cols()).mean() / of_flat, factor, 0.02 * factor) << radius;
  }
}

TEST(InformativeAreas, GiveNothingToLooseVerticesAndToFacesWithoutArea) {
  TriangleMesh mesh = shapes::square_grid(2);
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols(1) = Vector3(9, 9, 9);
  const Eigen::VectorXd informative = informative_areas(TargetSurface(mesh), unit_length);
  EXPECT_TRUE(informative.allFinite());
  EXPECT_EQ(informative[informative.size() - 1], 0);
  mesh.vertices.bottomRows(2).setZero();  // all on one line
  EXPECT_EQ(informative_areas(TargetSurface(mesh), unit_length), Eigen::VectorXd::Zero(mesh.vertices.cols()));
}

}  // namespace
}  // namespace bespoke
