#include "bespoke/anchors/patch_borders.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "bespoke/anchors/anchor_curves.h"
#include "bespoke/error.h"
#include "support/error_message.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The faces of a grid over the unit square with their middles in a rectangle.
std::vector<int> faces_within(const TriangleMesh& mesh, double left, double right, double low, double high) {
  std::vector<int> faces;
  for (int face = 0; face < mesh.faces.cols(); ++face) {
    const Vector3 middle = mesh.vertices(Eigen::all, mesh.faces.col(face)).rowwise().mean();
    if (middle.x() > left && middle.x() < right && middle.y() > low && middle.y() < high)
      faces.push_back(face);
  }
  return faces;
}

PatchSide side(std::vector<int> faces) { return {Points(3, 0), std::move(faces)}; }

double area_on_the_left(const Points& line) {
  double twice = 0;
  for (Eigen::Index i = 0; i < line.cols(); ++i)
    twice += line.col(i).cross(line.col((i + 1) % line.cols())).z();
  return twice / 2;
}

TEST(BordersOfFaces, RunAroundThemWithTheFacesOnTheLeft) {
  const TriangleMesh square = shapes::square_grid(10);
  const auto borders = borders_of_faces(square, faces_within(square, 0.2, 0.6, 0.3, 0.8));
  ASSERT_EQ(borders.size(), 1u);
  EXPECT_TRUE(borders[0].closed);
  EXPECT_EQ(borders[0].line.cols(), 18);
  const Points corners{{0.2, 0.6, 0.6, 0.2}, {0.3, 0.3, 0.8, 0.8}, {0, 0, 0, 0}};
  EXPECT_LT(distance_from_polyline(corners, true, borders[0].line), 1e-12);
  // Only the corners are cut, by half an edge each way.
  EXPECT_NEAR(area_on_the_left(borders[0].line), 0.2 - 4 * 0.05 * 0.05 / 2, 1e-12);
}

TEST(BordersOfFaces, AreStraightWhereTheEdgesZigzag) {
  const TriangleMesh square = shapes::square_grid(12);
  std::vector<int> faces;
  for (int face = 0; face < square.faces.cols(); ++face) {
    const Vector3 middle = square.vertices(Eigen::all, square.faces.col(face)).rowwise().mean();
    // Whole squares on one side of a line that crosses the diagonals: a staircase.
    const int column = static_cast<int>(middle.x() * 12), row = static_cast<int>(middle.y() * 12);
    if (column + row < 12) faces.push_back(face);
  }
  const auto borders = borders_of_faces(square, faces);
  ASSERT_EQ(borders.size(), 1u);
  ASSERT_FALSE(borders[0].closed);
  const Points inner = borders[0].line.middleCols(1, borders[0].line.cols() - 2);
  for (const auto& x : inner.colwise()) EXPECT_NEAR(x.x() + x.y(), 1 + 0.5 / 12, 1e-12);
}

TEST(BordersOfFaces, LeaveOutTheBoundaryOfTheMeshAndShowHoles) {
  const TriangleMesh square = shapes::square_grid(10);
  const auto strip = borders_of_faces(square, faces_within(square, 0.4, 1, 0, 1));
  ASSERT_EQ(strip.size(), 1u);
  EXPECT_FALSE(strip[0].closed);
  EXPECT_TRUE(strip[0].line.row(0).isConstant(0.4, 1e-12));
  EXPECT_GT(strip[0].line(1, 0), strip[0].line(1, 5));  // downwards has the strip on its left
  EXPECT_NEAR(strip[0].line.row(1).maxCoeff() - strip[0].line.row(1).minCoeff(), 1, 1e-12);

  std::vector<int> ring = faces_within(square, 0.1, 0.9, 0.1, 0.9);
  for (const int face : faces_within(square, 0.4, 0.6, 0.4, 0.6)) std::erase(ring, face);
  EXPECT_EQ(borders_of_faces(square, ring).size(), 2u);

  std::vector<int> all(static_cast<std::size_t>(square.faces.cols()));
  std::iota(all.begin(), all.end(), 0);
  EXPECT_TRUE(borders_of_faces(square, all).empty());
}

class PatchBorders : public ::testing::Test {
 protected:
  PatchBorders() {
    for (const Vector3& a : {Vector3(0.1, 0.1, 0), Vector3(0.9, 0.2, 0), Vector3(0.5, 0.9, 0)})
      anchors_.pairs.push_back({"", a, a + shift_});
  }

  const Vector3 shift_{3, -1, 2};
  TriangleMesh source_ = shapes::square_grid(20);
  TriangleMesh target_ = shapes::moved(shapes::square_grid(30), {Matrix3::Identity(), shift_});
  Anchors anchors_;
};

TEST_F(PatchBorders, BelongTogetherAsThePairsLie) {
  // Two islands a side, in another order on the target.
  std::vector<int> a = faces_within(source_, 0.1, 0.3, 0.2, 0.6);
  for (const int face : faces_within(source_, 0.6, 0.8, 0.2, 0.6)) a.push_back(face);
  const TriangleMesh in_place = shapes::moved(target_, {Matrix3::Identity(), -shift_});
  std::vector<int> b = faces_within(in_place, 0.6, 0.8, 0.2, 0.6);
  for (const int face : faces_within(in_place, 0.1, 0.3, 0.2, 0.6)) b.push_back(face);
  anchors_.patches = {{"stand", {}, side({0}), true}, {"islands", side(a), side(b), false}};
  const auto borders = patch_borders(anchors_, source_, target_);
  ASSERT_EQ(borders.size(), 2u);
  for (const PatchBorder& border : borders) {
    EXPECT_EQ(border.patch, 1u);
    EXPECT_EQ(border.curve.name, "islands");
    EXPECT_LT((border.curve.a.rowwise().mean() + shift_ - border.curve.b.rowwise().mean()).norm(), 0.02);
  }
}

TEST_F(PatchBorders, AreRefusedWhereTheOtherModelHasMore) {
  std::vector<int> ring = faces_within(source_, 0.1, 0.9, 0.1, 0.9);
  for (const int face : faces_within(source_, 0.4, 0.6, 0.4, 0.6)) std::erase(ring, face);
  const PatchSide one{Points{{3.1, 3.9, 3.9}, {-0.9, -0.9, -0.1}, {2, 2, 2}}, {}};
  anchors_.patches = {{"ring", side(ring), one, false}};
  EXPECT_THAT(test::error_message<InvalidInput>([&] { patch_borders(anchors_, source_, target_); }),
              AllOf(HasSubstr("patch \"ring\" on the source has 2 closed borders"),
                    HasSubstr("but 1 on the target")));
}

}  // namespace
}  // namespace bespoke
