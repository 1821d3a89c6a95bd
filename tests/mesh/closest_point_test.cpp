#include "bespoke/mesh/closest_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "bespoke/error.h"
#include "support/shapes.h"

namespace bespoke {
namespace {

Points random_points(int count, double extent, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-extent, extent);
  Points points(3, count);
  for (double& value : points.reshaped()) value = uniform(random);
  return points;
}

TriangleMesh triangle_soup(int count, unsigned seed) {
  TriangleMesh soup;
  soup.vertices = random_points(3 * count, 1, seed);
  soup.faces.resize(3, count);
  for (int i = 0; i < 3 * count; ++i) soup.faces.reshaped()(i) = i;
  return soup;
}

// Of a tree over this face alone: no traversal, so it serves as the reference for whole trees.
SurfacePoint closest_on_face(const TriangleMesh& mesh, Eigen::Index face, const Vector3& x) {
  TriangleMesh one{mesh.vertices, mesh.faces.col(face)};
  return ClosestPointTree(one).closest(x).value();
}

// The variational property of a closest point y of a convex set: (x − y)·(z − y) ≤ 0 for all of its corners
// z.
void expect_closest_on_triangle(const TriangleMesh& mesh, const Vector3& x, const SurfacePoint& at) {
  for (const int corner : mesh.faces.col(at.face)) {
    const Vector3 z = mesh.vertices.col(corner);
    EXPECT_LE((x - at.point).dot(z - at.point), 1e-12 * (1 + x.squaredNorm()));
  }
}

void expect_consistent(const TriangleMesh& mesh, const Vector3& x, const SurfacePoint& at) {
  Vector3 combined = Vector3::Zero();
  for (int k = 0; k < 3; ++k) combined += at.barycentric(k) * mesh.vertices.col(mesh.faces(k, at.face));
  EXPECT_LT((combined - at.point).norm(), 1e-14 * (1 + at.point.norm()));
  EXPECT_GE(at.barycentric.minCoeff(), 0);
  EXPECT_NEAR(at.barycentric.sum(), 1, 1e-15);
  EXPECT_DOUBLE_EQ(at.squared_distance, (x - at.point).squaredNorm());
}

TEST(ClosestPoint, OnATriangleMeetsTheVariationalInequality) {
  const TriangleMesh mesh = triangle_soup(1, 1);
  const ClosestPointTree tree(mesh);
  const Points queries = random_points(2000, 3, 2);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    const SurfacePoint at = tree.closest(queries.col(i)).value();
    expect_closest_on_triangle(mesh, queries.col(i), at);
    expect_consistent(mesh, queries.col(i), at);
  }
}

TEST(ClosestPoint, InEveryRegionOfATriangle) {
  const ClosestPointTree tree(shapes::triangle());
  const auto expect = [&](const Vector3& x, const Vector3& y) {
    EXPECT_LT((tree.closest(x)->point - y).norm(), 1e-15) << x.transpose();
  };
  expect({0.25, 0.25, 3}, {0.25, 0.25, 0});
  expect({0.5, -1, 1}, {0.5, 0, 0});
  expect({-1, 0.5, 1}, {0, 0.5, 0});
  expect({1, 1, -1}, {0.5, 0.5, 0});
  expect({-1, -2, 0}, {0, 0, 0});
  expect({4, 1, 0}, {1, 0, 0});
  expect({1, 4, 0}, {0, 1, 0});
}

TEST(ClosestPoint, AgreesWithAskingEveryFace) {
  const TriangleMesh mesh = triangle_soup(300, 3);
  const ClosestPointTree tree(mesh);
  const Points queries = random_points(200, 1.5, 4);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    int face = -1;
    for (Eigen::Index k = 0; k < mesh.faces.cols(); ++k) {
      const double squared = closest_on_face(mesh, k, queries.col(i)).squared_distance;
      if (squared < least) {
        least = squared;
        face = static_cast<int>(k);
      }
    }
    const SurfacePoint at = tree.closest(queries.col(i)).value();
    EXPECT_EQ(at.squared_distance, least);
    EXPECT_EQ(at.face, face);
    expect_consistent(mesh, queries.col(i), at);
  }
}

TEST(ClosestPoint, OfASpheresVertexRayIsTheVertexWhateverTheDistance) {
  const TriangleMesh sphere = shapes::icosphere(3);
  const ClosestPointTree tree(sphere);
  for (const double radius : {1.0, 1.5, 1e3, 1e9})
    for (Eigen::Index i = 0; i < sphere.vertices.cols(); i += 7)
      EXPECT_LT((tree.closest(radius * sphere.vertices.col(i))->point - sphere.vertices.col(i)).norm(), 1e-6);
}

TEST(ClosestPoint, OfEqualDistanceBelongsToTheLeastFace) {
  // Straight above shared edges and corners of a grid that is not representable exactly.
  const AffineMap tilt{Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()).toRotationMatrix() / 3,
                       {0.1, 0.2, 0.3}};
  const TriangleMesh mesh = shapes::moved(shapes::square_grid(20), tilt);
  const ClosestPointTree tree(mesh);
  for (Eigen::Index vertex = 0; vertex < mesh.vertices.cols(); ++vertex) {
    int least = static_cast<int>(mesh.faces.cols());
    for (int face = static_cast<int>(mesh.faces.cols()) - 1; face >= 0; --face)
      if ((mesh.faces.col(face).array() == static_cast<int>(vertex)).any()) least = face;
    EXPECT_EQ(tree.closest(mesh.vertices.col(vertex))->face, least);
  }
  TriangleMesh twice = shapes::joined(mesh, mesh);
  const ClosestPointTree tree_of_both(twice);
  const Points queries = random_points(300, 1, 5);
  for (Eigen::Index i = 0; i < queries.cols(); ++i)
    EXPECT_LT(tree_of_both.closest(queries.col(i))->face, mesh.faces.cols());
}

TEST(ClosestPoint, OfEqualDistanceAcrossARidgeBelongsToTheLeastFace) {
  // Outside a convex edge both faces give the same point of it, whichever way they run along it.
  const TriangleMesh cube = shapes::moved(shapes::cube(), {Matrix3::Identity() / 3, {0.1, 0.2, 0.3}});
  TriangleMesh reversed = cube;
  for (Eigen::Index face = 0; face < cube.faces.cols(); ++face)
    reversed.faces.col(face) = cube.faces.col(cube.faces.cols() - 1 - face);
  const ClosestPointTree tree(cube), tree_of_reversed(reversed);
  const Points queries = random_points(2000, 2, 6);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    const SurfacePoint at = tree.closest(queries.col(i)).value();
    const SurfacePoint back = tree_of_reversed.closest(queries.col(i)).value();
    EXPECT_EQ(at.point, back.point);
    const int other = 11 - back.face;
    EXPECT_LE(at.face, other);
  }
}

TEST(ClosestPoint, WithinADistance) {
  const ClosestPointTree tree(shapes::triangle());
  EXPECT_TRUE(tree.closest({0.25, 0.25, 2}, {.max_distance = 2}));
  EXPECT_FALSE(tree.closest({0.25, 0.25, 2}, {.max_distance = 1.999}));
  EXPECT_TRUE(tree.closest({0.25, 0.25, 0}, {.max_distance = 0}));
  EXPECT_THROW(tree.closest({0, 0, 0}, {.max_distance = -1}), InvalidInput);
  EXPECT_THROW(tree.closest({0, 0, 0}, {.max_distance = std::nan("")}), InvalidInput);
}

TEST(ClosestPoint, AmongCompatibleNormals) {
  const ClosestPointTree tree(shapes::cube());
  // From just inside the lower side the upper one is the only one that faces up.
  EXPECT_EQ(tree.closest({0.5, 0.5, 0.1}, {.normal = Vector3(0, 0, 1)})->point, Vector3(0.5, 0.5, 1));
  EXPECT_EQ(tree.closest({0.5, 0.5, 0.1}, {.normal = Vector3(0, 0, -1)})->point, Vector3(0.5, 0.5, 0));
  EXPECT_FALSE(tree.closest({0.5, 0.5, 0.1}, {.normal = Vector3(1, 1, 1).normalized(), .min_cosine = 0.6}));
  EXPECT_FALSE(tree.closest({0.5, 0.5, 0.1}, {.max_distance = 0.5, .normal = Vector3(0, 0, 1)}));
}

TEST(ClosestPoint, WithNormalsAgreesWithAskingEveryFace) {
  const TriangleMesh mesh = triangle_soup(200, 7);
  const Points normals = face_normals(mesh);
  const ClosestPointTree tree(mesh);
  const Points queries = random_points(100, 1.5, 8);
  const Points directions = random_points(100, 1, 9).colwise().normalized();
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index k = 0; k < mesh.faces.cols(); ++k)
      if (normals.col(k).dot(directions.col(i)) > 0.5)
        least = std::min(least, closest_on_face(mesh, k, queries.col(i)).squared_distance);
    const Vector3 direction = directions.col(i);
    EXPECT_EQ(tree.closest(queries.col(i), {.normal = direction, .min_cosine = 0.5})->squared_distance,
              least);
  }
}

TEST(ClosestPoint, CountsTheDifferenceOfNormalsLikeALength) {
  constexpr double normal_length = 0.3, reach = 0.8;
  const TriangleMesh soup = triangle_soup(300, 21);
  const ClosestPointTree tree(soup);
  const Points normals = face_normals(soup), queries = random_points(200, 1, 22);
  for (Eigen::Index i = 0; i < queries.cols(); ++i) {
    ClosestPointQuery query;
    query.normal = Vector3(queries.col(i)).cross(Vector3(1, 2, 3)).normalized();
    query.normal_length = normal_length;
    query.max_distance = reach;
    double least = reach * reach;
    for (Eigen::Index face = 0; face < soup.faces.cols(); ++face) {
      if (!(normals.col(face).dot(*query.normal) > 0)) continue;
      least =
          std::min(least, closest_on_face(soup, face, queries.col(i)).squared_distance +
                              std::pow(normal_length, 2) * (normals.col(face) - *query.normal).squaredNorm());
    }
    const auto found = tree.closest(queries.col(i), query);
    ASSERT_EQ(found.has_value(), least < reach * reach);
    if (!found) continue;
    EXPECT_NEAR(found->squared_distance, least, 1e-12);
    expect_closest_on_triangle(soup, queries.col(i), *found);
  }
}

TEST(ClosestPoint, OnFacesWithoutArea) {
  TriangleMesh mesh;
  mesh.vertices = Points{{0, 1, 2, 5, 5}, {0, 0, 0, 5, 5}, {0, 0, 0, 5, 5}};
  mesh.faces = Faces{{0, 1, 3}, {2, 1, 4}, {1, 1, 3}};
  const ClosestPointTree tree(mesh);
  EXPECT_EQ(tree.closest({1.5, 1, 0})->point, Vector3(1.5, 0, 0));
  EXPECT_EQ(tree.closest({9, 9, 9})->point, Vector3(5, 5, 5));
  EXPECT_EQ(tree.closest({1, 1, 0})->face, 0);
  EXPECT_FALSE(tree.closest({1.5, 1, 0}, {.normal = Vector3(0, 0, 1), .min_cosine = -1}));
}

TEST(ClosestPoint, OnSliversIsAsNearAsTheirEdges) {
  std::mt19937 random(10);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const double thickness : {1e-4, 1e-7, 1e-9, 1e-12}) {
    TriangleMesh mesh;
    mesh.vertices = Points{{0, 1, 0.4}, {0, 0, thickness}, {0, 0, 0}};
    mesh.faces = Faces{{0}, {1}, {2}};
    const ClosestPointTree tree(mesh);
    for (int i = 0; i < 200; ++i) {
      const Vector3 x(uniform(random), uniform(random), uniform(random));
      const Vector3 on_line(std::clamp(x.x(), 0.0, 1.0), 0, 0);
      EXPECT_NEAR(std::sqrt(tree.closest(x)->squared_distance), (x - on_line).norm(), 2 * thickness + 1e-15);
    }
  }
}

TEST(ClosestPoint, FarFromTheOrigin) {
  const Vector3 offset(1e7, -1e7, 1e7);
  const TriangleMesh mesh = shapes::moved(shapes::icosphere(3), {Matrix3::Identity(), offset});
  const ClosestPointTree tree(mesh);
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i)
    EXPECT_EQ(tree.closest(mesh.vertices.col(i))->squared_distance, 0);
}

TEST(ClosestPoint, OfManyFacesAtOnePlaceAndOfGeometricallyShrinkingOnes) {
  TriangleMesh mesh = shapes::triangle();
  mesh.faces = Eigen::Vector3i(0, 1, 2).replicate(1, 5000);
  EXPECT_EQ(ClosestPointTree(mesh).closest({0.25, 0.25, 1})->face, 0);
  TriangleMesh shrinking = shapes::triangle();
  for (int i = 1; i < 1000; ++i)
    shrinking = shapes::joined(
        shrinking,
        shapes::moved(shapes::triangle(), {std::exp2(-i) * Matrix3::Identity(), {0, 0, std::exp2(-i)}}));
  const ClosestPointTree tree(shrinking);
  for (int i = 1; i < 40; ++i) EXPECT_EQ(tree.closest({0, 0, std::exp2(-i)})->face, i);
}

TEST(ClosestPoint, OfAMovedTreeIsThatOfANewOne) {
  const TriangleMesh mesh = triangle_soup(3000, 8);
  const ClosestPointTree tree(mesh);
  const Points queries = random_points(500, 2, 9);
  for (const double strength : {0.0, 0.1, 5.0}) {
    TriangleMesh bent = mesh;
    for (auto&& x : bent.vertices.colwise())
      x += strength * Vector3(std::sin(9 * x[1]), x[0] * x[2], std::cos(7 * x[0]));
    const ClosestPointTree fresh(bent), moved = tree.moved(bent), back = moved.moved(mesh);
    for (const auto& x : queries.colwise()) {
      const SurfacePoint expected = fresh.closest(x).value(), at = moved.closest(x).value();
      EXPECT_EQ(at.face, expected.face);
      EXPECT_EQ(at.point, expected.point);
      EXPECT_EQ(at.barycentric, expected.barycentric);
      EXPECT_EQ(back.closest(x).value().point, tree.closest(x).value().point);
    }
  }
}

TEST(ClosestPoint, RefusesToMoveToOtherFacesOrNonFiniteVertices) {
  const ClosestPointTree tree(shapes::icosphere(1));
  EXPECT_THROW(tree.moved(shapes::icosphere(2)), InvalidInput);
  TriangleMesh broken = shapes::icosphere(1);
  broken.vertices(2, 5) = std::nan("");
  EXPECT_THROW(tree.moved(broken), InvalidInput);
}

TEST(ClosestPoint, RefusesWhatHasNoAnswer) {
  EXPECT_THROW(ClosestPointTree({}), InvalidInput);
  TriangleMesh mesh = shapes::triangle();
  mesh.vertices(0, 0) = std::nan("");
  EXPECT_THROW(ClosestPointTree{mesh}, InvalidInput);
  const ClosestPointTree tree(shapes::triangle());
  EXPECT_THROW(tree.closest({0, std::nan(""), 0}), InvalidInput);
  EXPECT_THROW(tree.closest({0, 0, std::numeric_limits<double>::infinity()}), InvalidInput);
}

TEST(DistancesFromVertices, BoundThoseFromTheSurfaceAndAreZeroAtVertices) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const ClosestPointTree tree(sphere);
  Points queries = random_points(50, 2, 4);
  queries.leftCols(10) = sphere.vertices.leftCols(10);
  const std::vector<double> most = distances_from_vertices(sphere, queries);
  ASSERT_EQ(most.size(), 50u);
  for (Eigen::Index i = 0; i < queries.cols(); ++i)
    EXPECT_GE(most[std::size_t(i)], std::sqrt(tree.closest(queries.col(i))->squared_distance) - 1e-6);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_EQ(most[i], 0);
  EXPECT_TRUE(distances_from_vertices({}, queries).empty());
}

TEST(Carried, PointsGoWithTheirFaceByAnyAffineMap) {
  const TriangleMesh sphere = shapes::icosphere(2);
  const ClosestPointTree tree(sphere);
  const AffineMap map{(Matrix3() << 2, 1, 0, 0, 0.5, 0, -1, 0, 3).finished(), Vector3(4, 5, 6)};
  const Points moved = map * sphere.vertices, queries = random_points(50, 1, 3);
  for (const auto& x : queries.colwise()) {
    const SurfacePoint place = *tree.closest(x);
    EXPECT_LT((carried(place, sphere.faces, sphere.vertices) - place.point).norm(), 1e-14);
    EXPECT_LT((carried(place, sphere.faces, moved) - map * place.point).norm(), 1e-13);
  }
}

}  // namespace
}  // namespace bespoke
