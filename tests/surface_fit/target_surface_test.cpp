#include "bespoke/surface_fit/matching/target_surface.h"

#include <gtest/gtest.h>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

TEST(TargetSurface, FindsThePointBelowWithItsNormal) {
  const TargetSurface surface(shapes::square_grid(4));
  const auto found = surface.match(Vector3(0.3, 0.6, 0.2), Vector3(0, 0.6, 0.8), {0.5, 1});
  ASSERT_TRUE(found);
  EXPECT_LT((found->point - Vector3(0.3, 0.6, 0)).norm(), 1e-12);
  EXPECT_LT((found->normal - Vector3(0, 0, 1)).norm(), 1e-12);
  EXPECT_LT((found->halfway - Vector3(0, 0.6, 1.8).normalized()).norm(), 1e-12);
  EXPECT_NEAR(found->agreement, 0.8, 1e-12);
  EXPECT_NEAR(surface.closest(Vector3(0.3, 0.6, -0.2)).squared_distance, 0.04, 1e-12);
}

TEST(TargetSurface, GivesNoPointOnItsBoundary) {
  const TargetSurface surface(shapes::square_grid(4));
  const Vector3 up(0, 0, 1);
  EXPECT_FALSE(surface.match(Vector3(-0.1, 0.5, 0), up, {0, 1}));   // beside an edge
  EXPECT_FALSE(surface.match(Vector3(1.1, 1.2, 0.1), up, {0, 1}));  // beyond a corner
  EXPECT_TRUE(surface.match(Vector3(0.01, 0.5, 0), up, {0, 1}));
}

TEST(TargetSurface, AnswersOnItsBoundaryWhereThatIsAllowed) {
  const TargetSurface surface(shapes::square_grid(4));
  const auto found = surface.match(Vector3(-0.1, 0.5, 0), Vector3::UnitZ(), {0, 1, 0, true});
  ASSERT_TRUE(found);
  EXPECT_EQ(found->point, Vector3(0, 0.5, 0));
}

TEST(TargetSurface, AnswersAtInnerEdgesAndVertices) {
  const TargetSurface surface(shapes::square_grid(2));
  for (const Vector3& x : {Vector3(0.5, 0.5, 0.1), Vector3(0.5, 0.25, 0.1)}) {
    const auto found = surface.match(x, Vector3::UnitZ(), {0, 1});
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->point.isApprox(Vector3(x[0], x[1], 0), 1e-14));
  }
}

TEST(TargetSurface, PassesOverFacesThatFaceAway) {
  TriangleMesh sheet = shapes::square_grid(4);
  TriangleMesh far_sheet = sheet;
  far_sheet.vertices.row(2).setConstant(-1);
  sheet.faces.row(0).swap(sheet.faces.row(1));  // the near one faces down
  const TargetSurface surface(shapes::joined(sheet, far_sheet));
  const auto found = surface.match(Vector3(0.3, 0.6, 0.1), Vector3::UnitZ(), {0, 2});
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->point.isApprox(Vector3(0.3, 0.6, -1), 1e-14));
}

TEST(TargetSurface, MeasuresDistancesWhateverTheNormals) {
  const TargetSurface surface(shapes::square_grid(2));
  Points points(3, 3);
  points << 0.5, 0.5, 1.5,  //
      0.5, 0.5, 0.5,        //
      0.25, -0.75, 0;
  const Statistics found = distances(surface, points);
  EXPECT_EQ(found.count, 3u);
  EXPECT_NEAR(found.min, 0.25, 1e-14);
  EXPECT_NEAR(found.median, 0.5, 1e-14);
  EXPECT_NEAR(found.max, 0.75, 1e-14);
}

TEST(TargetSurface, GivesNoPointThatIsFarOrFacesAway) {
  const TargetSurface surface(shapes::square_grid(4));
  EXPECT_FALSE(surface.match(Vector3(0.5, 0.5, 0.2), Vector3(0, 0, 1), {0, 0.1}));
  EXPECT_FALSE(surface.match(Vector3(0.5, 0.5, 0.2), Vector3(0, 0, -1), {0, 1}));
  EXPECT_FALSE(surface.match(Vector3(0.5, 0.5, 0.2), Vector3::Zero(), {0, 1}));
}

TEST(TargetSurface, MovesWithItsBoundary) {
  const TriangleMesh square = shapes::square_grid(4);
  const TargetSurface lifted = TargetSurface(square).moved(square.vertices.colwise() + Vector3(0, 0, 2));
  EXPECT_NEAR(lifted.closest(Vector3(0.5, 0.5, 0)).squared_distance, 4, 1e-12);
  EXPECT_FALSE(lifted.match(Vector3(-0.1, 0.5, 2), Vector3(0, 0, 1), {0, 1}));
}

TEST(TargetSurface, KnowsAreasAndBoundary) {
  const TargetSurface square(shapes::square_grid(3));
  EXPECT_NEAR(square.areas().sum(), 1, 1e-12);
  EXPECT_EQ(square.boundary_edges().cols(), 12);
  EXPECT_EQ(TargetSurface(shapes::cube()).boundary_edges().cols(), 0);
  TriangleMesh empty;
  EXPECT_THROW(TargetSurface{empty}, InvalidInput);
}

/// The left half of the unit square is patch 0, the right half is in none, the square above is excluded.
FacePatches halves_of(const TriangleMesh& mesh) {
  FacePatches patches;
  for (const auto& face : mesh.faces.colwise()) {
    const Vector3 middle = mesh.vertices(Eigen::all, face).rowwise().mean();
    patches.of_face.push_back(middle.z() > 0.1   ? FacePatches::excluded
                              : middle.x() < 0.5 ? 0
                                                 : FacePatches::none);
  }
  return patches;
}

void expect_answers_in_one_patch(const TargetSurface& surface) {
  const Vector3 up = Vector3::UnitZ();
  MatchLimits limits{0, 1};
  const auto left = [&] { return surface.match({0.3, 0.6, 0.15}, up, limits); };
  EXPECT_EQ(left()->point, Vector3(0.3, 0.6, 0.2));
  limits.patch = 0;
  EXPECT_EQ(left()->point, Vector3(0.3, 0.6, 0));
  EXPECT_LT(surface.mesh().vertices(0, surface.mesh().faces.col(left()->face)).mean(), 0.5);
  EXPECT_FALSE(surface.match({0.7, 0.6, 0.05}, up, limits));  // nearest where the patch ends
  limits.matches_boundary = true;
  EXPECT_EQ(surface.match({0.7, 0.6, 0.05}, up, limits)->point, Vector3(0.5, 0.6, 0));
  limits.matches_boundary = false;
  limits.patch = FacePatches::none;
  EXPECT_FALSE(left());
  EXPECT_EQ(surface.match({0.7, 0.6, 0.15}, up, limits)->point, Vector3(0.7, 0.6, 0));
  for (const int nobody : {FacePatches::excluded, 1}) {
    limits.patch = nobody;
    EXPECT_FALSE(left());
  }
}

TEST(TargetSurface, AnswersInOnePatchOnly) {
  const TriangleMesh square = shapes::square_grid(4);
  const TriangleMesh both =
      shapes::joined(square, shapes::moved(square, {Matrix3::Identity(), Vector3(0, 0, 0.2)}));
  const TargetSurface surface(both, halves_of(both));
  expect_answers_in_one_patch(surface);
  expect_answers_in_one_patch(surface.moved(both.vertices));
  MatchLimits limits{0, 1};
  limits.patch = 3;  // a surface without patches does not ask
  EXPECT_TRUE(TargetSurface(square).match({0.3, 0.6, 0.15}, Vector3::UnitZ(), limits));
}

TEST(TargetSurface, KnowsThePatchOfAVertex) {
  const TriangleMesh square = shapes::square_grid(4);
  const TargetSurface surface(square, halves_of(square));
  for (Eigen::Index i = 0; i < square.vertices.cols(); ++i) {
    const double x = square.vertices(0, i);
    const std::optional<int> expected = x < 0.5   ? std::optional(0)
                                        : x > 0.5 ? std::optional(FacePatches::none)
                                                  : std::nullopt;
    EXPECT_EQ(surface.patch(i), expected);
    EXPECT_FALSE(surface.is_excluded(i));
  }
  EXPECT_EQ(TargetSurface(square).patch(0), std::nullopt);
}

}  // namespace
}  // namespace bespoke
