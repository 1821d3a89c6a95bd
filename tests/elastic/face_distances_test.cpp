#include "bespoke/elastic/detail/face_distances.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "bespoke/mesh/closest_point.h"
#include "support/instruction_sets.h"
#include "support/random_points.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

std::vector<Matrix3> triangles(const TriangleMesh& mesh) {
  std::vector<Matrix3> result(static_cast<std::size_t>(mesh.faces.cols()));
  for (Eigen::Index face = 0; face < mesh.faces.cols(); ++face)
    for (int corner = 0; corner < 3; ++corner)
      result[static_cast<std::size_t>(face)].col(corner) = mesh.vertices.col(mesh.faces(corner, face));
  return result;
}

/// The distance from every face, each asked as a mesh of its own.
std::vector<double> distances_one_by_one(const std::vector<Matrix3>& faces, const Vector3& x) {
  std::vector<double> result;
  TriangleMesh mesh = shapes::triangle();
  for (const Matrix3& face : faces) {
    mesh.vertices = face;
    result.push_back(ClosestPointTree(mesh).closest(x)->squared_distance);
  }
  return result;
}

TEST(FaceDistances, FindsExactlyTheFacesWithinTheRadius) {
  for (const TriangleMesh& mesh : {shapes::icosphere(2), shapes::cube(), shapes::triangle(),
                                   shapes::joined(shapes::icosphere(1), shapes::square_grid(7))}) {
    const std::vector<Matrix3> faces = triangles(mesh);
    for (const double radius : {0.05, 0.4, 5.0}) {
      const FaceDistances distances(faces, radius);
      FaceDistances::Scratch scratch;
      const Points x = 1.5 * test::random_points(60, 3);
      for (Eigen::Index i = 0; i < x.cols(); ++i) {
        std::map<int, double> found;
        for (const FaceDistances::Near& near : distances.find(x.col(i), scratch))
          found[distances.order()[static_cast<std::size_t>(near.place)]] = near.squared_distance;
        const std::vector<double> expected = distances_one_by_one(faces, x.col(i));
        for (std::size_t face = 0; face < faces.size(); ++face) {
          const auto at = found.find(static_cast<int>(face));
          ASSERT_EQ(at != found.end(), expected[face] < radius * radius);
          if (at == found.end()) continue;
          EXPECT_NEAR(at->second, expected[face], 1e-13);
        }
      }
    }
  }
}

TEST(FaceDistances, IsZeroOnTheFacesUpToRounding) {
  const TriangleMesh mesh = shapes::icosphere(2);
  const FaceDistances distances(triangles(mesh), 0.01);
  FaceDistances::Scratch scratch;
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    const auto& near = distances.find(mesh.vertices.col(i), scratch);
    EXPECT_GE(near.size(), 5u);
    for (const FaceDistances::Near& at : near) EXPECT_LT(at.squared_distance, 1e-30);
  }
}

TEST(FaceDistances, GivesTheSameBitsWithEveryInstructionSet) {
  const FaceDistances distances(triangles(shapes::icosphere(3)), 0.4);
  const Points x = 1.5 * test::random_points(200, 5);
  test::expect_same_bits_with_every_instruction_set([&] {
    FaceDistances::Scratch scratch;
    std::vector<double> numbers;
    for (Eigen::Index i = 0; i < x.cols(); ++i)
      for (const FaceDistances::Near& near : distances.find(x.col(i), scratch)) {
        numbers.push_back(near.place);
        numbers.push_back(near.squared_distance);
      }
    return numbers;
  });
}

TEST(FaceDistances, FindsNothingFarAway) {
  const FaceDistances distances(triangles(shapes::cube()), 0.5);
  FaceDistances::Scratch scratch;
  EXPECT_TRUE(distances.find(Vector3(1e6, -1e6, 1e300), scratch).empty());
  EXPECT_TRUE(distances.find(Vector3::Constant(std::nan("")), scratch).empty());
}

}  // namespace
}  // namespace bespoke
