#include "bespoke/alignment/placement.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TriangleMesh flattened_ellipsoid() {
  TriangleMesh mesh = shapes::icosphere(3);
  mesh.vertices = Vector3(2, 1, 0.7).asDiagonal() * mesh.vertices;
  return mesh;
}

TEST(PlacementScore, FindsNothingWrongWithASimilarCopy) {
  const TriangleMesh source = flattened_ellipsoid();
  const Matrix3 rotation = Eigen::AngleAxisd(1.2, Vector3(1, -1, 2).normalized()).toRotationMatrix();
  const TriangleMesh target{(3 * rotation * source.vertices).colwise() + Vector3(5, 6, 7), source.faces};
  const PlacementFigures figures = PlacementScore(source, target)(target.vertices);
  EXPECT_LT(figures.distance, 1e-9);
  EXPECT_LT(figures.distortion, 1e-9);
  EXPECT_NEAR(figures.covered, 1, 1e-12);
}

TEST(PlacementScore, MeasuresTheDistanceOfAShiftedPlane) {
  const TriangleMesh plane = shapes::square_grid(10);
  const double offset = 0.002 * diagonal(plane.vertices);
  const Points placed = plane.vertices.colwise() + Vector3(0, 0, offset);
  const PlacementFigures figures = PlacementScore(plane, plane)(placed);
  EXPECT_NEAR(figures.distance, 0.002, 1e-9);
  EXPECT_LT(figures.distortion, 1e-9);
}

TEST(PlacementScore, SeesThatHalfOfTheTargetIsLeftOut) {
  const TriangleMesh plane = shapes::square_grid(40);
  Points half = plane.vertices;
  half.row(0) /= 2;
  const PlacementFigures figures = PlacementScore(plane, plane)(half);
  // What lies within 1 % of the diagonal beside the half counts too.
  EXPECT_GT(figures.covered, 0.5);
  EXPECT_LT(figures.covered, 0.55);
  EXPECT_GT(figures.distortion, 0.1);
}

TEST(PlacementFigures, PreferLessDistortionAmongThoseThatMeetTheTarget) {
  const PlacementFigures calm{1.01e-4, 0.10, 1}, folded{1.00e-4, 0.11, 1}, aside{2e-3, 0.09, 0.95};
  EXPECT_LT(calm.misfit(), folded.misfit());
  EXPECT_LT(folded.misfit(), aside.misfit());
}

TEST(PlacementScore, RejectsAnotherNumberOfVertices) {
  const TriangleMesh cube = shapes::cube();
  EXPECT_THROW(PlacementScore(cube, cube)(Points::Zero(3, 2)), InvalidInput);
}

}  // namespace
}  // namespace bespoke
