#include "bespoke/mesh/cavities.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <vector>

#include "support/pocketed_ball.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

constexpr double narrow = 9 * std::numbers::pi / 180;  // of a pocket's mouth

bool at_the_mouth(const Vector3& x) { return x.z() > 0.85 && x.head<2>().norm() < 0.35; }

TEST(EnclosedVertices, AreThoseOfAPocketWithANarrowMouth) {
  const TriangleMesh mesh = shapes::pocketed_ball(narrow);
  const std::vector<char> enclosed = enclosed_vertices(mesh);
  for (std::size_t i = 0; i < enclosed.size(); ++i) {
    const Vector3 x = mesh.vertices.col(static_cast<Eigen::Index>(i));
    if (!at_the_mouth(x)) {
      EXPECT_EQ(enclosed[i] != 0, shapes::in_pocket(x)) << x.transpose();
    }
  }
}

TEST(EnclosedVertices, AreTheSameInAnyPlaceAndSize) {
  const TriangleMesh mesh = shapes::pocketed_ball(narrow);
  const TriangleMesh moved = shapes::moved(mesh, {400 * test::random_rotation(3), Vector3(30, -500, 2)});
  const std::vector<char> here = enclosed_vertices(mesh), there = enclosed_vertices(moved);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < here.size(); ++i) differing += here[i] != there[i];
  EXPECT_LE(differing, here.size() / 50);  // looks are not the same ones about another normal
}

TEST(EnclosedVertices, AreNoneOfASurfaceInTheOpenOrInsideOut) {
  TriangleMesh ball = shapes::icosphere(3);
  const auto none = [](const TriangleMesh& mesh) {
    const std::vector<char> enclosed = enclosed_vertices(mesh);
    return std::none_of(enclosed.begin(), enclosed.end(), [](char is) { return is != 0; });
  };
  EXPECT_TRUE(none(ball));
  ball.faces.row(1).swap(ball.faces.row(2));
  EXPECT_TRUE(none(ball));
  EXPECT_TRUE(none(shapes::square_grid(5)));
}

TEST(Cavities, AreThePocketsOneByOne) {
  const TriangleMesh one = shapes::pocketed_ball(narrow);
  const TriangleMesh two =
      shapes::joined(one, shapes::moved(one, {test::random_rotation(4), Vector3(9, 0, 0)}));
  const Cavities cavities = cavities_of(two);
  ASSERT_EQ(cavities.parts.size(), 2u);
  const auto size = static_cast<int>(one.vertices.cols());
  for (std::size_t part = 0; part < 2; ++part)
    for (const int vertex : cavities.parts[part].vertices) {
      EXPECT_EQ(vertex >= size, part == 1);
      const Vector3 x = one.vertices.col(vertex % size);
      EXPECT_TRUE(shapes::in_pocket(x) || at_the_mouth(x)) << x.transpose();
      EXPECT_TRUE(cavities.contains[static_cast<std::size_t>(vertex)]);
    }
}

TEST(Cavities, AreNotTheWallsOfAGapThatIsOpenAllAround) {
  TriangleMesh block = shapes::cube();
  for (int k = 0; k < 4; ++k) block = shapes::subdivided(block);
  const TriangleMesh pair = shapes::joined(block, shapes::moved(block, {Matrix3::Identity(), {1.02, 0, 0}}));
  const std::vector<char> enclosed = enclosed_vertices(pair);
  EXPECT_GT(std::count(enclosed.begin(), enclosed.end(), 1), 200);
  const Cavities cavities = cavities_of(pair);
  EXPECT_TRUE(cavities.parts.empty());
  EXPECT_EQ(std::count(cavities.contains.begin(), cavities.contains.end(), 1), 0);
}

}  // namespace
}  // namespace bespoke
